-- Directions: fibre fields at their limits, in a block that is pulled apart with damage.
--
--   both       alpha = -1 along both families: only what is across both breaks
--   parallel   the second family is given all but parallel to the first: it is made orthogonal
--   across     fibres across the pull
--   seam       directions that jump to their opposite in the middle
--   zero       a field that is zero at places: no direction can be made of it
--   stiff      gamma = 1e4
local s = require "sunder"
local p = s.params { duration = 0.3, fps = 40, dx = 0.1, variant = s.choice { "both", "parallel", "across", "seam", "zero", "stiff" } }
local v = p.variant
local fibres = v == "both" and s.fibres.direction({ 1, 0, 0 }, { 0, 1, 0 })
            or v == "parallel" and s.fibres.direction({ 1, 0, 0 }, { 1, 1e-3, 0 })
            or v == "across" and s.fibres.direction { 0, 0, 1 }
            or v == "seam" and s.fibres.field(function(x, y, z) return x < 0 and 1 or -1, 0.5, 0 end)
            or v == "zero" and s.fibres.field(function(x, y, z) return x < 0 and 1 or 0, 0, 0 end)
            or s.fibres.direction { 1, 1, 0 }
local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.2, 9, 9 } }, velocity = { side * 0.5, 0, 0 } }
end

return s.scene {
  title  = "Directions",
  solids = { { shape = s.box { size = { 1, 0.3, 0.3 }, center = { 0, 0, 0 } }, fibres = fibres,
               material = { density = 1, elastic = { E = 1000, nu = 0.3 }, fibres = { gamma = v == "stiff" and 1e4 or 10, gamma2 = v == "both" and 10 or 0 },
                            damage = { break_stretch = 0.05, eta = 0.01, alpha = -1, alpha2 = v == "both" and -1 or 0 } } } },
  grips  = { grip(-1), grip(1) },
  expect = v == "zero" and { stop = "fibre" }
        or { energy_gain = 0.02, speed_max = 30, determinant_min = 0.05, determinant_max = 10, fibre_stretch_min = 0.2 },
}
