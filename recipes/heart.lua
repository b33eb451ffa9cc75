-- The heart of AnisoMPM's Fig. 14 (Table 1 gives sigma_c = 6.342, a break_stretch of 18.3 %): soft, fibres three times as
-- stiff as itself, and a yield stress of 4, so that it is drawn out of shape for good before it tears. `plastic = false`
-- gives the elastic heart that the paper compares with.
return {
  density = 2,
  elastic = { E = 100, nu = 0.25, lame = "paper" },
  fibres  = { gamma = 3 },
  plastic = { yield_stress = 4 },
  damage  = { break_stretch = 0.183, eta = 0.1, alpha = -1, residual = 0.01 },
}
