-- expect: 79_notches_without_a_list.lua:5 key=solids[1].notches found=a_shape says a list of shapes
local s = require "sunder"
return s.scene { particles = 1000, solids = { {
  shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 }, damage = { sigma_c = 1 } },
  notches = s.box { size = { 1, 0.2, 1 } } } } }
