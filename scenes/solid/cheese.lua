-- Cheese: a stick of string cheese stands on its foot and is peeled from its top, eight ways at once.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 7 and Table 1, and the values of the authors' published scene (500 000
-- particles, eight balls of radius 0.015 that move outwards at speed 0.1 and 26.6 degrees, 160 frames at 24 a second). The
-- stick has the volume that their grid and particles come to; that they peel downwards is our reading of the figure.
--
-- What to look for: strands that come away along the stick, thin where they part from it, and hardly any tear across.
--
-- Try:  sunder run scenes/solid/cheese.lua --set angle=60                    steeper: longer strands
--       sunder run scenes/solid/cheese.lua --set alpha=0 --set gamma=0       bread
local s = require "sunder"

local p = s.params {
  particles = 60000,
  duration  = { 160 / 24, unit = "time", doc = "160 frames" },
  fps       = 24,
  speed     = { 0.1, unit = "length/time", doc = "of each ball", min = 0 },
  angle     = { 26.6, unit = "degrees", doc = "of the pull below the horizontal", min = -90, max = 90 },
  ball      = { 0.015, unit = "length", doc = "radius of each ball; a ball smaller than a grid cell holds nothing", min = 0.001 },
  ways      = { 8, doc = "how many balls", min = 1, max = 16 },
}

local radius, length = 0.05, 0.3
local fall = math.rad(p.angle)

local grips = { { name = "foot", shape = s.box { min = { -1, -1, -1 }, max = { 1, 0.03, 1 } } } }
for i = 1, p.ways do
  local a = 2 * math.pi * (i - 0.5) / p.ways
  local x, z = math.cos(a), math.sin(a)
  grips[#grips + 1] = {
    name     = "ball_" .. i,
    shape    = s.sphere { center = { 0.75 * radius * x, length - p.ball, 0.75 * radius * z }, radius = p.ball },
    velocity = { p.speed * math.cos(fall) * x, -p.speed * math.sin(fall), p.speed * math.cos(fall) * z },
  }
end

return s.scene {
  title = "Cheese",

  transfer       = "rpic",
  transfer_ratio = 0.01,
  cfl            = 0.7, -- what is damped so may take longer steps than a half: nearer to the paper's

  solids = {
    {
      name     = "stick",
      shape    = s.cylinder { axis = "y", radius = radius, length = length, center = { 0, length / 2, 0 } },
      material = s.recipe "mozzarella",
      fibres   = s.fibres.direction { 0, 1, 0 },
    },
  },
  grips = grips,
}
