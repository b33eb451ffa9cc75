-- Plastic: flow at its limits.
--
--   soft       a yield stress of next to nothing: it flows at once, like a liquid
--   far        a bar drawn to five times its length
--   forged     a block crushed between two plates to a third of its height
local s = require "sunder"
local p = s.params { duration = 0.4, fps = 40, dx = 0.1, variant = s.choice { "soft", "far", "forged" } }
local v = p.variant
local matter = { density = 1, elastic = { E = 1000, nu = 0.3 }, plastic = { yield_stress = v == "soft" and 1e-12 or 10, hardening = v == "forged" and 50 or 0 } }
local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.2, 9, 9 } }, velocity = { side * 5, 0, 0 } }
end

return s.scene {
  title     = "Plastic", gravity = { 0, v == "soft" and -10 or 0, 0 },
  solids    = { { shape = v == "far" and s.box { size = { 1, 0.3, 0.3 }, center = { 0, 0, 0 } } or s.box { min = { -0.3, 0, -0.3 }, max = { 0.3, 0.6, 0.3 } }, material = matter } },
  grips     = v == "far" and { grip(-1), grip(1) } or nil,
  walls     = v ~= "far" and { { point = { 0, 0, 0 }, normal = "y", contact = "slip" } } or nil,
  colliders = v == "forged" and { { shape = s.box { min = { -2, 0.6, -2 }, max = { 2, 0.8, 2 } }, velocity = { 0, -1, 0 }, contact = "separate" } } or nil,
  expect    = { energy_gain = 0.02, speed_max = 30, determinant_min = 0.2, determinant_max = 5, low_y = v ~= "far" and -0.1 or nil },
}
