-- Meat: a slab of raw meat lies on a board, one end held; after half a second the other end is pulled until it tears.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 1 and Table 1, and the values of the authors' published scene (500 000
-- particles, a held box and a puller from 0.5 s, 72 frames at 24 a second, PIC). Their mesh is not published: ours is a slab
-- of the same volume with round edges, torn at 45 degrees to its grain so that the grain has something to decide.
--
-- What to look for: the tear follows the grain, slantwise, and strands go on holding the two sides together (a tenth of the
-- stiffness is left in what is torn).
--
-- Try:  sunder run scenes/solid/meat.lua --set grain=90                the grain across the pull: a straight tear
--       sunder run scenes/solid/meat.lua --set grain=20                nearly along it: long slanting strands
--       sunder run scenes/solid/meat.lua --set alpha=0 --set gamma=0   minced
local s = require "sunder"

local p = s.params {
  particles = 120000,
  duration  = { 3, unit = "time", doc = "72 frames" },
  fps       = 24,
  pull      = { 0.2, unit = "length/time", doc = "speed of the puller", min = 0 },
  from_t    = { 0.5, unit = "time", doc = "when the puller starts; until then the meat settles on the board", min = 0 },
  grain     = { 45, unit = "degrees", doc = "of the fibres from the pull", min = -90, max = 90 },
  friction  = { 0.2, doc = "between the meat and the board", min = 0, max = 10 },
}

-- A slab .56 × .12 × .36: a box with capsules for its long edges.
local half, thick, wide = 0.28, 0.06, 0.18
local rim = wide - thick
local function edge(z)
  return s.capsule { from = { -half + thick, thick, z }, to = { half - thick, thick, z }, radius = thick }
end
local slab = s.box { min = { -half, 0, -rim }, max = { half, 2 * thick, rim } } + edge(rim) + edge(-rim)

local angle = math.rad(p.grain)
local hold = 0.09 -- how much of each end is held

return s.scene {
  title   = "Meat",
  gravity = { 0, -9.8, 0 },

  transfer = "pic",
  cfl      = 0.7, -- what is damped so may take longer steps than a half: nearer to the paper's

  solids = {
    {
      name     = "meat",
      shape    = slab,
      material = s.recipe "meat",
      fibres   = s.fibres.direction { math.cos(angle), 0, math.sin(angle) },
    },
  },

  -- The puller lets the meat settle first, so it holds still until from_t and then moves.
  grips = {
    { name = "held", shape = s.box { min = { -1, -0.1, -1 }, max = { hold - half, 1, 1 } } },
    {
      name     = "puller",
      shape    = s.box { min = { half - hold, -0.1, -1 }, max = { 1, 1, 1 } },
      velocity = function(t) return t < p.from_t and 0 or p.pull, 0, 0 end,
    },
  },

  walls = { { name = "board", point = { 0, 0, 0 }, normal = "y", contact = "separate", friction = p.friction } },
}
