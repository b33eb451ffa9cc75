-- expect: 49_one_solid_without_a_list.lua:4 key=solids says list of solids
local s = require "sunder"
return s.scene { particles = 1000,
  solids = { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } }
