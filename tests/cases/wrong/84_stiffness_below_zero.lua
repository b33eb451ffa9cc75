-- expect: 84_stiffness_below_zero.lua:5 key=solids[1].material.elastic.E says above 0
local s = require "sunder"
return s.scene { particles = 1000, solids = { {
  shape = s.sphere { radius = 1 },
  material = { density = 1, elastic = { E = function(x, y, z) return -1 end } } } } }
