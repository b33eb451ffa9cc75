-- Contact of a sheet and a solid, under a blow and from within.
--
--   shot     a ball at a free film, at the speed of its waves
--   inside   a film that starts inside a ball
local s = require "sunder"
local p = s.params { duration = 0.05, fps = 100, dx = 0.05, variant = s.choice { "shot", "inside" } }
local shot = p.variant == "shot"

return s.scene {
  title   = "Contact of both kinds",
  contact = 0.5,
  solids  = { { shape = s.sphere { center = { 0, 0, shot and 0.25 or 0.08 }, radius = 0.2 }, velocity = shot and { 0, 0, -10 } or nil,
                material = { density = 10, elastic = { E = 1000, nu = 0.3 } } } },
  sheets  = { { shape = s.rectangle { size = { 0.6, 0.6 } }, thickness = 0.02, spacing = 0.03, material = { density = 100, linear = { E = 1e4 } } } },
  expect  = { momentum_drift = 1e-4, speed_max = 60 },
}
