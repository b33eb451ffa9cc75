-- Broken: a body that is broken everywhere from the start falls on a floor. Cells hold nothing but broken particles.
--
--   residual      it keeps a hundredth of its stiffness
--   nothing       it keeps none: no force against stretching is left, and the step must not collapse
--   rare_frames   the same with two frames in a unit of time: no wave limits the step, gravity must
--   implicit      with the implicit form
--   phase_field   the same with the phase field
local s = require "sunder"
local p = s.params { duration = 0.5, dx = 0.1, variant = s.choice { "residual", "nothing", "rare_frames", "implicit", "phase_field" } }
local v = p.variant
local damage = v ~= "phase_field" and { sigma_c = 10, eta = 0.01, residual = v == "residual" and 0.01 or 0, form = v == "implicit" and "implicit" or "explicit" } or nil

return s.scene {
  title   = "Broken", fps = v == "rare_frames" and 2 or 40, gravity = { 0, -10, 0 },
  solids  = { { shape = s.box { min = { -0.3, 0.2, -0.3 }, max = { 0.3, 0.8, 0.3 } }, notches = { s.sphere { radius = 9 } },
                material = { density = 1, elastic = { E = 1000, nu = 0.3 }, damage = damage, pff = v == "phase_field" and { toughness = 0.1, residual = 0 } or nil } } },
  walls   = { { point = { 0, 0, 0 }, normal = "y", contact = "separate", friction = 0.2 } },
  expect  = { energy_gain = 0.02, broken_fraction = { 0.99, 1 }, speed_max = 10, low_y = -0.1, steps = 3000 },
}
