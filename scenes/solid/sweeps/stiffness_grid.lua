-- Stiffness: the notched block of sigma_eta.lua over E and gamma, AnisoMPM (Wolper et al. 2020), Fig. 18. The figure's values are not
-- given; these are the jelly's own, and a fifth and five times as much. break_stretch stays, so sigma_c follows E.
--
-- Run:  sunder sweep scenes/solid/sweeps/stiffness_grid.lua -j 2
local s = require "sunder"

return s.sweep {
  title = "Stiffness",
  scene = "../sigma_eta.lua",
  set   = { particles = 20000 },
  over  = { E = { 40, 200, 1000 }, gamma = { 2, 10, 50 } },
}
