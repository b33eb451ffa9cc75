-- expect: 54_grip_stops_before_it_starts.lua:5 key=grips[1].stop says after start
local s = require "sunder"
return s.scene { particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
  grips = { { shape = s.sphere { radius = 0.5 }, start = 2, stop = 1 } } }
