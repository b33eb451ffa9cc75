-- A paper towel (sheet paper, Fig. 8; it has no column in Table 1): light, with a grain, weak when wet.
return {
  density = 100,
  linear = { E = 2e4 },
  fracture = { G = 2.4 },
  grain = { stiffness = 2, toughness = 1.5 },
}
