-- expect: 76_iterator_kept.lua:8 key=grips[1].velocity says iterator
local s = require "sunder"
local words = ("1 2 3 4 5 6 7 8 9"):gmatch("%d")
return s.scene { particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
  grips = { {
    shape = s.sphere { radius = 0.5 },
    velocity = function(t) return tonumber(words()), 0, 0 end } } }
