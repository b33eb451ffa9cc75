-- A rubbery film (sheet paper, Table 1, "Rubbery Film"). Without c_star it is neo-Hookean at small stretch; G sets where it tears,
-- at about twice its length.
return {
  density = 100,
  rubber = { E = 100, c_star = 0, n = 2 },
  fracture = { G = 11.3 },
}
