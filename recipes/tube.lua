-- The tube of AnisoMPM's tube pull (Fig. 2; Table 1 gives sigma_c = 31960, which is what a break_stretch of 20 %
-- comes to). Fibres ten times as stiff as the matrix; damage that leaves stress along them alone, so that cracks run
-- along the fibres.
--
-- Naming an effect turns it on. Leaving it out, or `effect = false` where the recipe is used, leaves it out of the
-- program that runs.
return {
  density = 500,
  elastic = { E = 4e4, nu = 0.45 },
  fibres  = { gamma = 10 },
  damage  = { break_stretch = 0.20, eta = 0.45, alpha = -1, residual = 0.01 },
}
