-- expect: 82_function_of_what_cannot_vary.lua:5 key=solids[1].material.elastic.nu found=a_function says a finite number
local s = require "sunder"
return s.scene { particles = 1000, solids = { {
  shape = s.sphere { radius = 1 },
  material = { density = 1, elastic = { E = 1, nu = function(x, y, z) return 0.3 end } } } } }
