-- Disk shoot: a sphere pushes slowly through a disk that is held at its rim; the fibres decide how the disk opens.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 12, and the values of the authors' published scene (50 000 particles, a ring
-- of radius 0.4 that holds the rim, a sphere of radius 0.1 at speed 0.1, 144 frames at 24 a second). The disk's thickness is
-- ours: not quite four grid cells with 50 000 particles.
--
--   variant          fibres                what to look for
--   radial           like spokes           cracks along the spokes: petals, as of a tin that was shot
--   circumferential  like hoops            a round lid that is punched out
--   vertical         up                    one slit, upright
--   horizontal       across                one slit, lying
--   diagonal         at 45 degrees         one slit at 45 degrees
--   isotropic        none                  a ragged hole without a direction
--
-- Our choices beside the measures: the sphere only pushes, with some friction; there is no gravity.
--
-- Try:  sunder run scenes/solid/disk_shoot.lua --set variant=vertical --set speed=0.2
local s = require "sunder"

local p = s.params {
  particles = 50000,
  duration  = { 6, unit = "time", doc = "144 frames" },
  fps       = 24,
  speed     = { 0.1, unit = "length/time", doc = "of the sphere", min = 0 },
  thickness = { 0.06, unit = "length", doc = "of the disk", min = 0.005, max = 0.2 },
  friction  = { 0.3, doc = "between the sphere and the disk", min = 0, max = 10 },
  variant   = s.choice { "radial", "circumferential", "vertical", "horizontal", "diagonal", "isotropic" },
}

local radius, ball = 0.4, 0.1

-- The disk faces along z, so "vertical" is y as in the figure.
local fibres = ({
  radial          = s.fibres.radial { axis = "z" },
  circumferential = s.fibres.circumferential { axis = "z" },
  vertical        = s.fibres.direction { 0, 1, 0 },
  horizontal      = s.fibres.direction { 1, 0, 0 },
  diagonal        = s.fibres.direction { 1, 1, 0 },
})[p.variant] -- none for "isotropic"

local damage = { break_stretch = 0.07, eta = 0.1, alpha = fibres and -1 or 0 }

return s.scene {
  title = "Disk shoot",

  transfer       = "rpic",
  transfer_ratio = 0.01,

  solids = {
    {
      name     = "disk",
      shape    = s.cylinder { axis = "z", radius = radius, length = p.thickness },
      material = s.recipe("tube", { elastic = { lame = "paper" }, fibres = fibres and true or false, damage = damage }),
      fibres   = fibres,
    },
  },

  grips = { { name = "rim", shape = s.torus { axis = "z", major = radius, minor = 0.03 } } },

  colliders = {
    {
      name     = "ball",
      shape    = s.sphere { center = { 0, 0, -p.thickness / 2 - ball }, radius = ball },
      velocity = { 0, 0, p.speed },
      contact  = "separate",
      friction = p.friction,
    },
  },
}
