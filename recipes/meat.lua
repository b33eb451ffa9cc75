-- Raw meat, AnisoMPM's meat (Fig. 1; Table 1 gives sigma_c = 3995, a break_stretch of 20 %). Soft and nearly
-- incompressible, the grain ten times as stiff as what lies between. What is torn keeps a tenth of its stiffness: strands
-- go on hanging together, as wet tissue does.
return {
  density = 500,
  elastic = { E = 5e3, nu = 0.45, lame = "paper" },
  fibres  = { gamma = 10 },
  damage  = { break_stretch = 0.20, eta = 0.45, alpha = -1, residual = 0.1 },
}
