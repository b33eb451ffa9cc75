-- expect: 41_fibres_without_direction.lua:4 key=direction says not zero
local s = require "sunder"
return s.scene { particles = 1000, solids = { { shape = s.sphere { radius = 1 },
  fibres = s.fibres.direction { 0, 0, 0 },
  material = { density = 1, elastic = { E = 1 }, fibres = true } } } }
