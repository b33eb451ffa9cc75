-- Fish, skin and meat alike: AnisoMPM's fish (Fig. 6; Table 1 gives sigma_c = 35430, a break_stretch of 20 %). Brittle (an
-- eta of a hundredth of a second), and what has come loose keeps a tenth of its stiffness.
return {
  density = 1000,
  elastic = { E = 1e5, nu = 0.4, lame = "paper" },
  fibres  = { gamma = 8 },
  damage  = { break_stretch = 0.20, eta = 0.01, alpha = -1, residual = 0.1 },
}
