-- Fish: three hands hold a fish by its belly, three take the skin of its back at the head and peel it off towards the tail.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 6 and Table 1, and the values of the authors' published scene (50 000
-- particles, three balls that go up, three that hold, flow-generated fibres, 104 frames at 48 a second). Their mesh is not
-- published: ours is a lens seen from the side and from above, of the volume that their grid and particles come to, with a
-- tail fin; its skin is the same stuff as its meat. Where the balls sit, and their speed, are ours.
--
-- What to look for: a strip comes off the back along the fibres, which run from mouth to tail with the body's shape, and
-- it tears across nowhere.
--
-- Try:  sunder run scenes/solid/fish.lua --set alpha=0 --set gamma=0    no fibres: a lump comes off the back
local s = require "sunder"

local p = s.params {
  particles = 50000,
  duration  = { 104 / 48, unit = "time", doc = "104 frames" },
  fps       = 48,
  peel      = { 0.25, unit = "length/time", doc = "speed of the hands that peel, up and back", min = 0 },
}

-- The fish lies along x, mouth at +x. A lens of half length a and half width b is what two cylinders have in common.
local half, high, wide = 0.72, 0.23, 0.15
local function lens(axis, b)
  local R = (half * half + b * b) / (2 * b)
  local function side(sign)
    local center = axis == "z" and { 0, sign * (R - b), 0 } or { 0, 0, sign * (R - b) }
    return s.cylinder { axis = axis, radius = R, length = 2, center = center }
  end
  return side(1) * side(-1)
end
local body = lens("z", high) * lens("y", wide)
local stalk = s.capsule { from = { -0.55, 0, 0 }, to = { -0.8, 0, 0 }, radius = 0.05 }
local fin = s.box { min = { -0.9, -0.15, -0.04 }, max = { -0.76, 0.15, 0.04 } }
local fish = body + stalk + fin

-- Along the back, where the lens is `high` tall: y at x.
local function back(x)
  local R = (half * half + high * high) / (2 * high)
  return math.sqrt(R * R - x * x) - (R - high)
end

local function hand(name, x, y, radius, velocity)
  return { name = name, shape = s.sphere { center = { x, y, 0 }, radius = radius }, velocity = velocity }
end
local away = { -0.3 * p.peel, p.peel, 0 }

return s.scene {
  title = "Fish",

  transfer       = "rpic",
  transfer_ratio = 0.01,

  solids = {
    {
      name     = "fish",
      shape    = fish,
      material = s.recipe "fish",
      fibres   = s.fibres.flow { inflow  = s.box { min = { 0.6, -1, -1 }, max = { 1, 1, 1 } },
                                 outflow = s.box { min = { -1, -1, -1 }, max = { -0.86, 1, 1 } } },
    },
  },

  grips = {
    hand("peel_1", 0.40, back(0.40), 0.07, away),
    hand("peel_2", 0.30, back(0.30), 0.07, away),
    hand("peel_3", 0.20, back(0.20), 0.07, away),
    hand("hold_1", 0.35, -0.20, 0.12),
    hand("hold_2", 0, -0.23, 0.12),
    hand("hold_3", -0.35, -0.20, 0.12),
  },
}
