-- expect: 80_notch_that_is_no_shape.lua:5 key=solids[1].notches[2] found=3 says a shape
local s = require "sunder"
return s.scene { particles = 1000, solids = { {
  shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 }, damage = { sigma_c = 1 } },
  notches = { s.sphere { radius = 0.5 }, 3 } } } }
