-- expect: 51_friction_of_sticky.lua:5 key=walls[1].friction says sticky
local s = require "sunder"
return s.scene { particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
  walls = { { point = { 0, -1, 0 }, normal = "y", friction = 0.5 } } }
