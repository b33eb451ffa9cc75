-- Few: as little material as there can be, or too much of it in one place.
--
--   single       one particle falls on a floor
--   thin         a plate one cell thick, thrown flat on a floor
--   identical    two bodies in the same place, with every particle where one of the other is
--   thread       a row of particles, thinner than a cell
local s = require "sunder"
local p = s.params { duration = 0.5, fps = 40, dx = 0.1, variant = s.choice { "single", "thin", "identical", "thread" } }
local v = p.variant
local shape = v == "single" and s.box { min = { 0, 0.3, 0 }, max = { 0.05, 0.35, 0.05 } }
           or v == "thin" and s.box { min = { -0.6, 0.3, -0.6 }, max = { 0.6, 0.4, 0.6 } }
           or v == "thread" and s.box { min = { -0.6, 0.3, 0 }, max = { 0.6, 0.34, 0.04 } }
           or s.box { min = { -0.2, 0.1, -0.2 }, max = { 0.2, 0.5, 0.2 } }
local body = { shape = shape, sampling = "lattice", velocity = { 0, -1, 0 }, material = { density = 1, elastic = { E = 1000, nu = 0.3 } } }

return s.scene {
  title   = "Few", gravity = { 0, -10, 0 },
  solids  = v == "identical" and { body, body } or { body },
  walls   = { { point = { 0, 0, 0 }, normal = "y", contact = "separate", friction = 0.1 } },
  expect  = { energy_gain = 0.02, momentum_drift = 0.01, determinant_min = 0.5, determinant_max = 2, low_y = -0.1, speed_max = 8 },
}
