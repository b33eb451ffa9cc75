-- expect: 72_random_after_loading.lua:5 says pure
local s = require "sunder"
return s.scene { particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
  grips = { { shape = s.sphere { radius = 0.5 }, velocity = function(t) return math.random(), 0, 0 end } } }
