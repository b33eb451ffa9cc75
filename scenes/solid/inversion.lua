-- Inversion: a figure of tetrahedra starts in a state that no body is ever in, and finds back to its shape.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 19, where a gorilla does. The energy is defined for every F, inverted and singular ones
-- included, so forces are too.
--
--   variant     at time 0
--   random      every vertex is anywhere in a box, on its own                                (a)
--   collapsed   all vertices are in one point, but for seeds of 1e-6 of the figure's size    (b)
--
-- Without fibres a collapsed body stays as it is: no force acts where F = 0. With two families, gamma lambda / mu > 1, that state is
-- unstable, and the body opens again. Damping lets it come to rest.
--
-- Why tetrahedra: particles know their shape by F alone, which a step changes little by little, and vertices that share a cell of a grid share
-- one velocity field. Here F comes from where the corners are, and there is no grid: a point can open.
--
-- Try:  sunder run scenes/solid/inversion.lua --tui --set variant=collapsed
--       sunder run scenes/solid/inversion.lua --set variant=collapsed --set gamma=0 --set gamma2=0     stays a point
--       sunder run scenes/solid/inversion.lua --set model=corotated
local s = require "sunder"

local p = s.params {
  particles = { 800, unit = "1", doc = "vertices, about" },
  duration  = { 4, unit = "time", doc = "96 frames" },
  fps       = 24,
  variant   = s.choice { "random", "collapsed" },
  box       = { 0.6, unit = "length", doc = "side of the box, in the random variant", min = 0 },
  seeds     = { 1e-6, unit = "1", doc = "of the figure's size, in the collapsed variant", min = 0, max = 1 },
  model     = s.choice { "elastic", "corotated" },
}

-- From 0 to 1, for each place and each k: functions of place are pure, so chance is a function of the place.
local function chance(x, y, z, k)
  local v = math.sin(127.1 * x + 311.7 * y + 74.7 * z + 53.9 * k) * 43758.5453
  return v - math.floor(v)
end

-- Anywhere in a box of the given size, whatever the place at rest.
local function anywhere(size)
  return function(x, y, z)
    return size * (chance(x, y, z, 1) - 0.5), size * (chance(x, y, z, 2) - 0.5), size * (chance(x, y, z, 3) - 0.5)
  end
end

local function limb(x0, y0, x1, y1)
  return s.capsule { from = { -x0, y0, 0 }, to = { -x1, y1, 0 }, radius = 0.15 }
       + s.capsule { from = { x0, y0, 0 }, to = { x1, y1, 0 }, radius = 0.15 }
end

local figure = s.capsule { from = { 0, -0.25, 0 }, to = { 0, 0.3, 0 }, radius = 0.3 }
             + s.sphere { center = { 0, 0.75, 0 }, radius = 0.22 }
             + limb(0.3, 0.4, 0.75, -0.15)  -- arms
             + limb(0.2, -0.4, 0.35, -0.95) -- legs

return s.scene {
  title   = "Inversion",
  mass_damping = 6,
  solids  = {
    {
      name           = "figure",
      shape          = figure,
      discretisation = "tetrahedra",
      start          = anywhere(p.variant == "random" and p.box or 2 * p.seeds),
      fibres         = s.fibres.direction({ 0, 1, 0 }, { 1, 0, 0 }),
      material       = { density = 1, [p.model] = { E = 100, nu = 0.3 }, fibres = { gamma = 10, gamma2 = 10 } },
    },
  },
}
