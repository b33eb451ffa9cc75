-- Stretch: a bar pulled to 20 times its length, without damage.
--
--   grips        material points between two grips; where no cell holds two of them any more the bar comes apart, without harm
--   tetrahedra   a mesh, which stays one
--   uniform      soft material points that all move apart at once
local s = require "sunder"
local p = s.params { particles = 120, duration = 1, fps = 24, variant = s.choice { "grips", "tetrahedra", "uniform" } }
local v, pull = p.variant, 9.5 -- each end goes 9.5 lengths in a unit of time

local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.2, 9, 9 } }, velocity = { side * pull, 0, 0 } }
end

return s.scene {
  title  = "Stretch",
  dx     = v ~= "tetrahedra" and 0.1 or nil,
  solids = { { shape = s.box { size = { 1, 0.3, 0.3 }, center = { 0, 0, 0 } }, discretisation = v == "tetrahedra" and "tetrahedra" or "particles",
               velocity = v == "uniform" and function(x, y, z) return 30 * x, 0, 0 end or nil,
               material = { density = 1, elastic = { E = v == "uniform" and 1 or 1000, nu = 0.3 } } } },
  grips  = v ~= "uniform" and { grip(-1), grip(1) } or nil,
  expect = v == "grips" and { energy_gain = 0.02, speed_max = 150, determinant_min = 0.01 }
        or v == "tetrahedra" and { energy_gain = 0.02, deformation_end = { 8, 30 }, determinant_min = 0.01 }
        or { energy_gain = 0.02, momentum_drift = 1e-4, deformation_max = { 1.5, 30 } },
}
