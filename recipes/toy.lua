-- A soft toy: AnisoMPM's armadillo that is pierced by a lance (Fig. 9; Table 1 gives sigma_c = 12.67, a break_stretch of
-- 20 %). Light and soft, the fibres ten times as stiff as what lies between them, and it parts along them.
return {
  density = 1,
  elastic = { E = 100, nu = 0.3, lame = "paper" },
  fibres  = { gamma = 10 },
  damage  = { break_stretch = 0.20, eta = 0.1, alpha = -1, residual = 0.01 },
}
