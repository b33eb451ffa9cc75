-- expect: 35_velocity_results.lua:5 key=grips[1].velocity says 2 results
local s = require "sunder"
return s.scene { particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
  grips = { { shape = s.sphere { radius = 0.5 }, velocity = function(t) return t, 0 end } } }
