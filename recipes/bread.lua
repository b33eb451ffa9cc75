-- Bread: soft, crumbly, and weaker where it is wet. Values are chosen to look right, not measured: a crumb gives way at a
-- few per cent, water takes four fifths of its stiffness and strength, and a soaked crumb swells by 4 %.
return {
  density   = 200,
  elastic   = { E = 2e3, nu = 0.2 },
  damage    = { break_stretch = 0.2, eta = 0.01, residual = 0.001 },
  diffusion = { k = 1, C = 1 },
  swelling  = 0.04,
  softening = { stiffness = 0.8, strength = 0.8, floor = 0.05 },
}
