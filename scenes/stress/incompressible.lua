-- Incompressible: a block of nu near 1/2 drops on a floor. Its waves are fast and its volume must stay.
local s = require "sunder"
local p = s.params { duration = 0.2, fps = 50, dx = 0.1, variant = s.choice { "nu_0499", "nu_04999", "corotated" } }
local nu = p.variant == "nu_04999" and 0.4999 or 0.499

return s.scene {
  title   = "Incompressible", gravity = { 0, -10, 0 },
  solids  = { { shape = s.box { min = { -0.3, 0.05, -0.3 }, max = { 0.3, 0.45, 0.3 } }, velocity = { 0, -2, 0 },
                material = { density = 1, [p.variant == "corotated" and "corotated" or "elastic"] = { E = 1000, nu = nu } } } },
  walls   = { { point = { 0, 0, 0 }, normal = "y", contact = "separate" } },
  expect  = { energy_gain = 0.02, momentum_drift = 0.01, determinant_min = 0.8, determinant_max = 1.25, speed_max = 12 },
}
