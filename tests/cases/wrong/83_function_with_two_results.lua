-- expect: 83_function_with_two_results.lua:5 key=solids[1].material.elastic.E found=2_results says a finite number
local s = require "sunder"
return s.scene { particles = 1000, solids = { {
  shape = s.sphere { radius = 1 },
  material = { density = 1, elastic = { E = function(x, y, z) return 1, 2 end } } } } }
