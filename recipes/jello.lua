-- The jelly of AnisoMPM's notched blocks (Figs. 10, 11, 16, 18): light, soft, with fibres ten times as stiff as itself.
-- A break_stretch of 20 % is a sigma_c of 15.8.
return {
  density = 2,
  elastic = { E = 200, nu = 0.25, lame = "paper" },
  fibres  = { gamma = 10 },
  damage  = { break_stretch = 0.20, eta = 0.1, alpha = -1, residual = 0.01 },
}
