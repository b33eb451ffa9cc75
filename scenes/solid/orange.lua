-- Orange: half a slice of orange, flesh and skin, lies on a board and is torn open from its straight edge.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 5 and Table 1, and the values of the authors' published scene (50 000 + 30 000
-- particles at 20 a cell, three balls that pull, two that hold, 80 frames at 24 a second). Shape, ball radius and speed are
-- ours, and so is the board: half a disk of the volume that their grid and particles come to, lying flat.
--
-- What to look for: the flesh parts along its radial walls, from the core outwards, and the skin last. There are no stiff
-- fibres here: the authors found damage alone to look best for the orange, and for bone.
--
-- Try:  sunder run scenes/solid/orange.lua --set alpha=0       pulp without walls
local s = require "sunder"

local p = s.params {
  particles = 40000,
  particles_per_cell = 20,
  duration  = { 80 / 24, unit = "time", doc = "80 frames" },
  fps       = 24,
  pull      = { 0.08, unit = "length/time", doc = "speed of the balls that pull", min = 0 },
}

-- Half a disk about the core at the origin, seen from above: the straight edge behind, the skin in front (z > 0).
local flesh, skin, thick = 0.15, 0.175, 0.045
local function disk(radius)
  local whole = s.cylinder { axis = "y", radius = radius, length = thick, center = { 0, thick / 2, 0 } }
  return whole * s.half_space { normal = "-z" }
end

local walls = s.fibres.radial { axis = "y" }

-- Balls sit on the flesh and the skin: three on the right pull, two on the left hold.
local function ball(name, degrees, radius, velocity)
  local a = math.rad(degrees)
  return {
    name     = name,
    shape    = s.sphere { center = { radius * math.cos(a), thick / 2, radius * math.sin(a) }, radius = 0.03 },
    velocity = velocity,
  }
end
local out = { p.pull, 0, 0 }

return s.scene {
  title   = "Orange",
  gravity = { 0, -9.8, 0 },
  particles_per_cell = p.particles_per_cell,

  transfer       = "rpic",
  transfer_ratio = 0.01,
  cfl            = 0.7, -- what is damped so may take longer steps than a half: nearer to the paper's

  solids = {
    { name = "flesh", shape = disk(flesh), material = s.recipe "orange", fibres = walls },
    { name = "skin", shape = disk(skin) - disk(flesh), material = s.recipe "orange_skin", fibres = walls },
  },

  grips = {
    ball("pull_1", 8, 0.08, out),
    ball("pull_2", 8, 0.15, out),
    ball("pull_3", 30, 0.15, out),
    ball("hold_1", 172, 0.12),
    ball("hold_2", 150, 0.15),
  },

  walls = { { name = "board", point = { 0, 0, 0 }, normal = "y", contact = "separate", friction = 0.1 } },
}
