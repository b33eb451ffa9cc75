-- The flesh of an orange: AnisoMPM's orange tear, interior (Fig. 5; Table 1). The authors give sigma_c itself, from another
-- energy, so it is said here instead of a break_stretch. No stiff fibres: the pips' walls guide the tear and no more.
return {
  density = 500,
  elastic = { E = 1e4, nu = 0.40, lame = "paper" },
  damage  = { sigma_c = 2058, eta = 0.01, alpha = -1, residual = 0.001 },
}
