-- Sigma and eta: the notched block of sigma_eta.lua over critical stress and viscosity, AnisoMPM (Wolper et al. 2020), Fig. 10. The
-- figure's values are not given; these span from brittle to hardly broken.
--
-- Run:  sunder sweep scenes/solid/sweeps/sigma_eta_grid.lua -j 2
--       sunder runs list --where "tags LIKE '%sigma_eta_grid%'"
local s = require "sunder"

return s.sweep {
  title = "Sigma and eta",
  scene = "../sigma_eta.lua",
  set   = { particles = 20000 },
  over  = { break_stretch = { 0.1, 0.2, 0.3 }, eta = { 0.02, 0.1, 0.5 } },
}
