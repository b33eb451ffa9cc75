-- Aluminium foil, soft units (sheet paper, Table 1, "Foil"): yields, softens, tears.
--
-- The paper prints eta0 = 1e-4 beside G = 1.2. Bonds that yield there can take at most G = 0.002 before they part at the
-- paper's critical stretch sqrt(4 pi G/(9 E R)) = 0.118, so a sheet with those values has no strength: eta0 is 0.03 here, G and the
-- critical stretch are the paper's, and the decay follows from the three.
return {
  density = 5000,
  elastoplastic = { E = 2e3, nu = 0.3, poisson = "bond", eta0 = 0.03 },
  fracture = { G = 1.2, stretch = 0.118 },
}
