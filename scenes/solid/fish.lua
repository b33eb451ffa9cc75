-- Fish: three hands hold a fish by its belly, three take the skin of its back behind the head, where a cut has freed its edge,
-- and peel it off towards the tail.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 6 and Table 1, and the values of the authors' published scene (50 000
-- particles, three balls that go up, three that hold, flow-generated fibres, 104 frames at 48 a second). Their mesh is not
-- published: ours is a lens from every side, of the volume that their grid and particles come to, with a tail fin; its skin is
-- the same stuff as its meat. The cut, where the balls sit, and their speed, are ours.
--
-- What to look for: a strip comes off the back along the fibres, which run from mouth to tail with the body's shape, and
-- it tears across nowhere.
--
-- Try:  sunder run scenes/solid/fish.lua --set alpha=0 --set gamma=0    no fibres: the flap tears off
local s = require "sunder"

local p = s.params {
  particles = 50000,
  duration  = { 104 / 48, unit = "time", doc = "104 frames" },
  fps       = 48,
  peel      = { 0.25, unit = "length/time", doc = "speed of the hands that peel, up and back", min = 0 },
}

-- The fish lies along x, mouth at +x. A lens of half length a and half width b is what two cylinders have in common.
-- Four lenses, turned about the fish, round it off.
local half, high, wide = 0.72, 0.24, 0.16
local function lens(degrees)
  local up, out = math.cos(math.rad(degrees)), math.sin(math.rad(degrees))
  local b = math.sqrt((high * up) ^ 2 + (wide * out) ^ 2)
  local R = (half * half + b * b) / (2 * b)
  local function side(sign)
    return s.cylinder { axis = { 0, -out, up }, radius = R, length = 2, center = { 0, sign * (R - b) * up, sign * (R - b) * out } }
  end
  return side(1) * side(-1)
end
local body = lens(0) * lens(45) * lens(90) * lens(-45)
local stalk = s.capsule { from = { -0.55, 0, 0 }, to = { -0.8, 0, 0 }, radius = 0.05 }
local fin = s.box { min = { -0.9, -0.15, -0.04 }, max = { -0.76, 0.15, 0.04 } }
local fish = body + stalk + fin

-- Along the back, where the lens is `high` tall: y at x.
local function back(x)
  local R = (half * half + high * high) / (2 * high)
  return math.sqrt(R * R - x * x) - (R - high)
end

-- The cut: a layer of the meat below the skin, as deep as `skin`, with its edge behind the head.
local skin, edge = 0.10, 0.36
local function under(depth) return s.cylinder { axis = "z", radius = (half ^ 2 + high ^ 2) / (2 * high), length = 2,
                                                center = { 0, high - (half ^ 2 + high ^ 2) / (2 * high) - depth, 0 } } end
local cut = (under(skin) - under(skin + 0.04)) * s.box { min = { 0.12, 0, -1 }, max = { edge + 0.05, 1, 1 } }
  + s.box { min = { edge, back(edge) - skin - 0.04, -1 }, max = { edge + 0.05, 1, 1 } }

local function hand(name, x, y, z, radius, velocity)
  return { name = name, shape = s.sphere { center = { x, y, z }, radius = radius }, velocity = velocity }
end
local away = { -0.3 * p.peel, p.peel, 0 }

return s.scene {
  title = "Fish",

  transfer       = "rpic",
  transfer_ratio = 0.01,
  cfl            = 0.7, -- what is damped so may take longer steps than a half: nearer to the paper's

  solids = {
    {
      name     = "fish",
      shape    = fish,
      material = s.recipe "fish",
      notches  = { cut },
      fibres   = s.fibres.flow { inflow  = s.box { min = { 0.6, -1, -1 }, max = { 1, 1, 1 } },
                                 outflow = s.box { min = { -1, -1, -1 }, max = { -0.86, 1, 1 } } },
    },
  },

  grips = {
    hand("peel_1", 0.30, back(0.30) - 0.02, -0.05, 0.06, away),
    hand("peel_2", 0.30, back(0.30) - 0.02, 0, 0.06, away),
    hand("peel_3", 0.30, back(0.30) - 0.02, 0.05, 0.06, away),
    hand("hold_1", 0.35, -0.18, 0, 0.12),
    hand("hold_2", 0, -0.24, 0, 0.12),
    hand("hold_3", -0.35, -0.18, 0, 0.12),
  },
}
