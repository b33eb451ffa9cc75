-- A crisp seaweed flake (sheet paper, Table 1, "Seaweed"): linear and brittle.
return {
  density = 100,
  linear = { E = 2e4, nu = 0.3, poisson = "bond" },
  fracture = { G = 2.4 },
}
