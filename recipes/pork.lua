-- Braised pork belly: AnisoMPM's dongpo pork (Fig. 4; Table 1 gives sigma_c = 17.78, a break_stretch of 21 %). Two fibre
-- families span the layers, so that layers part from one another and are hard to tear across. With `alpha2 = 0` and
-- `gamma2 = 0` one family is left, and strips come off instead of layers.
return {
  density = 2,
  elastic = { E = 200, nu = 0.25, lame = "paper" },
  fibres  = { gamma = 10, gamma2 = 10 },
  damage  = { break_stretch = 0.21, eta = 0.1, alpha = -1, alpha2 = -1, residual = 0.01 },
}
