-- Eigenvalues: stresses with repeated eigenvalues, whose directions are anyone's. A non-symmetric solver gets them wrong (FACTS.md section 1).
--
--   triple       stretched alike in all directions
--   double       in two
--   double_fibres  in two, with anisotropic damage whose fibres lie across
local s = require "sunder"
local p = s.params { duration = 0.1, fps = 200, dx = 0.1, variant = s.choice { "triple", "double", "double_fibres" } }
local v = p.variant

return s.scene {
  title  = "Eigenvalues",
  solids = { { shape = s.box { size = { 0.6, 0.6, 0.6 }, center = { 0, 0, 0 } }, sampling = "lattice", fibres = v == "double_fibres" and s.fibres.direction { 0, 1, 1 } or nil,
               velocity = function(x, y, z) return 12 * x, 12 * y, v == "triple" and 12 * z or 0 end,
               material = { density = 1, elastic = { E = 1000, nu = 0.3 }, damage = { break_stretch = 0.1, eta = 0.01, alpha = v == "double_fibres" and -1 or 0 } } } },
  expect = { energy_gain = 0.01, momentum_drift = 1e-4, damage_max = { 0.01, 1 }, speed_max = 30, deformation_max = 20 },
}
