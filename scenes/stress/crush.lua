-- Crush: rigid plates press a block together, with nowhere to go.
--
--   press      to a tenth of its height, free at the sides
--   box        to a tenth of its height, within walls: det F of a tenth
--   flat       until the plates touch
--   tetrahedra pressed likewise, a mesh
--   grips      two grips hold the block's halves and are moved into each other, so that both have hold of its middle
local s = require "sunder"
local p = s.params { particles = 300, duration = 0.5, fps = 40, variant = s.choice { "press", "box", "flat", "tetrahedra", "grips" } }
local v = p.variant
local to = v == "flat" and 0.3 or 0.27 -- how far each plate goes; half the height is 0.3
local function plate(side)
  return { shape = s.box { min = { -3, side * 0.3 - (side < 0 and 0.5 or 0), -3 }, max = { 3, side * 0.3 + (side > 0 and 0.5 or 0), 3 } }, contact = "slip",
           velocity = function(t) return 0, t < 0.4 and -side * to / 0.4 or 0, 0 end }
end
local function grip(side)
  return { shape = s.box { size = { 3, 0.5, 3 }, center = { 0, 0.35 * side, 0 } }, velocity = function(t) return 0, t < 0.4 and -side * to / 0.4 or 0, 0 end }
end
local function wall(x, z) return { point = { -0.3 * x, 0, -0.3 * z }, normal = { x, 0, z }, contact = "slip" } end

return s.scene {
  title     = "Crush", dx = v ~= "tetrahedra" and 0.1 or nil,
  solids    = { { shape = s.box { size = { 0.6, 0.6, 0.6 }, center = { 0, 0, 0 } }, discretisation = v == "tetrahedra" and "tetrahedra" or "particles",
                  material = { density = 1, elastic = { E = 1000, nu = 0.3 } } } },
  colliders = v ~= "grips" and { plate(-1), plate(1) } or nil,
  grips     = v == "grips" and { grip(-1), grip(1) } or nil,
  walls     = v == "box" and { wall(1, 0), wall(-1, 0), wall(0, 1), wall(0, -1) } or nil,
  expect    = { energy_gain = 0.02, speed_max = 100, high_y = 0.4, low_y = -0.4 },
}
