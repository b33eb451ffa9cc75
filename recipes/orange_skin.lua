-- The skin of an orange: AnisoMPM's orange tear, exterior (Fig. 5; Table 1). Five times as stiff as the flesh, and by the
-- same sigma_c it breaks at a fifth of the flesh's stretch.
return {
  density = 500,
  elastic = { E = 5e4, nu = 0.40, lame = "paper" },
  damage  = { sigma_c = 2058, eta = 0.01, alpha = -1, residual = 0.001 },
}
