-- Inversion: a body of tetrahedra starts in a state that no body is ever in, and finds back to its shape.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 19 (a gorilla there; a torus with two arms' worth of bars here would do as well: the
-- mechanics are those of the mesh and of the energy).
--
--   variant     at time 0
--   random      every vertex is anywhere in a box, on its own                                   (a)
--   collapsed   all vertices are in one point, but for seeds of 1e-6 of the body's size         (b)
--
-- The energy is defined for every F, inverted and singular ones included, so forces are too. Without fibres a collapsed body stays as it is:
-- no force acts at F = 0. With two families of fibres and gamma lambda / mu > 1, F = 0 is unstable, and the body opens again.
--
-- There is no grid in such a scene: vertices in one cell of a grid share one velocity field, and a point could not open.
--
-- Try:  sunder run scenes/solid/inversion.lua --set variant=collapsed
--       sunder run scenes/solid/inversion.lua --set gamma=0 --set gamma2=0 --set variant=collapsed     stays a point
local s = require "sunder"

local p = s.params {
  particles = 1000,
  duration  = { 5, unit = "time", doc = "120 frames" },
  fps       = 24,
  variant   = s.choice { "random", "collapsed" },
  seeds     = { 1e-6, unit = "1", doc = "of the body's size, in the collapsed variant", min = 0, max = 1 },
}

-- A number from 0 to 1 for each place and each k: functions of place are pure, so chance is a function of the place.
local function chance(x, y, z, k)
  local v = math.sin(x * 127.1 + y * 311.7 + z * 74.7 + k * 53.9) * 43758.5453
  return v - math.floor(v)
end

local starts = {
  random = function(x, y, z)
    return chance(x, y, z, 1) - 0.5, chance(x, y, z, 2) - 0.5, chance(x, y, z, 3) - 0.5
  end,
  collapsed = function(x, y, z)
    return p.seeds * (chance(x, y, z, 1) - 0.5), p.seeds * (chance(x, y, z, 2) - 0.5), p.seeds * (chance(x, y, z, 3) - 0.5)
  end,
}

return s.scene {
  title   = "Inversion",
  damping = 5,
  solids  = {
    {
      name           = "block",
      shape          = s.box { min = { -0.5, -0.5, -0.5 }, max = { 0.5, 0.5, 0.5 } },
      discretisation = "tetrahedra",
      start          = starts[p.variant],
      fibres         = s.fibres.direction({ 1, 0, 0 }, { 0, 1, 0 }),
      material       = { density = 1, elastic = { E = 100, nu = 0.3 }, fibres = { gamma = 10, gamma2 = 10 } },
    },
  },
}
