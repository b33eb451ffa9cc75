-- expect: 85_density_that_counts.lua:6 key=solids[1].material.density found=write_to_the_upvalue_'calls' says pure
local s = require "sunder"
local calls = 0
return s.scene { particles = 1000, solids = { {
  shape = s.sphere { radius = 1 },
  material = { density = function(x, y, z) calls = calls + 1 return calls end, elastic = { E = 1 } } } } }
