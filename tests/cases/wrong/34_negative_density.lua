-- expect: 34_negative_density.lua:3 key=density found=-5
local s = require "sunder"
return s.scene { particles = 1000, solids = { { shape = s.sphere { radius = 1 }, material = { density = -5, elastic = { E = 1 } } } } }
