-- Rest: a block lies on a floor for a hundred thousand steps, without damping. Nothing may grow.
--
--   apic   after a drop of a tenth of its height
--   flip   the same with FLIP of ratio 1, which damps nothing: noise in what the grid does not see may not grow into motion
local s = require "sunder"
local p = s.params { duration = 140, fps = 0.1, dx = 0.1, variant = s.choice { "apic", "flip" } }

return s.scene {
  title    = "Rest", gravity = { 0, -10, 0 }, transfer = p.variant, transfer_ratio = p.variant == "flip" and 1 or 0,
  solids   = { { shape = s.box { min = { -0.1, 0, -0.1 }, max = { 0.1, 0.2, 0.1 } }, sampling = "lattice", material = { density = 1, elastic = { E = 1000, nu = 0.3 } } } },
  walls    = { { point = { 0, 0, 0 }, normal = "y", contact = "slip" } },
  expect   = { energy_gain = 0.01, speed_max = 1, determinant_min = 0.9, determinant_max = 1.1, spread = { 0.9, 1.1 } },
}
