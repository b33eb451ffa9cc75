-- Wet: what diffuses in a solid, too much of it or too fast.
--
--   swell         moisture that makes the body half as long again, with its ends held
--   soften        moisture that takes nearly all stiffness and strength, while it is drawn
--   fast          a conductivity of 1e9, which no explicit step follows: it says so
local s = require "sunder"
local p = s.params { duration = 0.2, fps = 50, dx = 0.1, variant = s.choice { "swell", "soften", "fast" } }
local v = p.variant
local matter = { density = 1000, elastic = { E = 1e5, nu = 0.3 }, diffusion = { k = v == "fast" and 1e9 or 1000, C = 1 } }
if v == "swell" then matter.swelling = 0.5 end
if v == "soften" then matter.softening = { stiffness = 1, strength = 1, floor = 1e-6 } matter.damage = { break_stretch = 0.1, eta = 0.01 } end

local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.21, 9, 9 } }, velocity = { v == "soften" and 0.1 * side or 0, 0, 0 } }
end

return s.scene {
  title  = "Wet",
  solids = { { shape = s.box { size = { 1, 0.4, 0.4 } }, material = matter, sources = { { shape = s.sphere { radius = 0.15 }, value = 1 } } } },
  mass_damping = 10,
  grips  = { grip(-1), grip(1) },
  expect = v == "fast" and { stop = "diffusion" } or { speed_max = 20, determinant_min = 0.02, diffused_min = -1e-4, diffused_max = 1.0001 },
}
