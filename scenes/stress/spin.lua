-- Spin: a free cylinder that turns fast, for many turns. Nothing may be lost: angular momentum, momentum, energy.
--
--   variant   slow: the rim at a tenth of the speed of waves; fast: at half of it, where it swells by centrifugal force
local s = require "sunder"
local p = s.params { duration = 8, fps = 5, dx = 0.125, variant = s.choice { "slow", "fast" } }
local waves = 35 -- speed of pressure waves: (E/density)^(1/2), about
local rate = (p.variant == "fast" and 0.5 or 0.1) * waves / 0.5

return s.scene {
  title  = "Spin",
  solids = { { shape    = s.cylinder { axis = "z", radius = 0.5, length = 0.4 },
               velocity = function(x, y, z) return -rate * y, rate * x, 0 end,
               material = { density = 1, elastic = { E = 1000, nu = 0.3 } } } },
  expect = { angular_drift = 1e-4, momentum_drift = 1e-5, energy_gain = 1e-3, determinant_min = 0.3, deformation_max = 3, spread = 1.5 },
}
