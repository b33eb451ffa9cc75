-- Flight: a block that flies through ten thousand cells, turning. It arrives where it should, as it was.
local s = require "sunder"
local p = s.params { duration = 100, fps = 0.2, dx = 0.1 }

return s.scene {
  title  = "Flight",
  solids = { { shape = s.box { size = { 0.15, 0.15, 0.15 }, center = { 0, 0, 0 } }, sampling = "lattice",
               velocity = function(x, y, z) return 10 - y, x, 0 end,
               material = { density = 1, elastic = { E = 10, nu = 0.3 } } } },
  expect = { energy_gain = 1e-3, momentum_drift = 1e-4, determinant_min = 0.95, determinant_max = 1.05, centre_x = { 999.9, 1000.1 }, spread = 1.35 },
}
