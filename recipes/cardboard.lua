-- The light, stiff matter of AnisoMPM's tube compress (Fig. 3; Table 1 gives sigma_c = 610.2, a break_stretch of 15 %).
-- It crumples under its own weight if it is made large: at a height of 1 and a gravity of 10 it carries itself easily.
return {
  density = 2,
  elastic = { E = 5e3, nu = 0.366 },
  fibres  = { gamma = 10 },
  damage  = { break_stretch = 0.15, eta = 0.3, alpha = -1, residual = 0.01 },
}
