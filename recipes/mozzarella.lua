-- String cheese: AnisoMPM's cheese (Fig. 7; Table 1 gives sigma_c = 3537, a break_stretch of 19 %). It comes apart in
-- strings: the strings are ten times as stiff as what glues them together, and the glue lets go within a tenth of a second.
return {
  density = 500,
  elastic = { E = 5e3, nu = 0.45, lame = "paper" },
  fibres  = { gamma = 10 },
  damage  = { break_stretch = 0.19, eta = 0.1, alpha = -1, residual = 0.01 },
}
