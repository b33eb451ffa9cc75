-- expect: 42_unbounded_body.lua:4 key=solids[1].shape says no end
local s = require "sunder"
return s.scene { particles = 1000, solids = { {
  shape = s.half_space { normal = "y" }, material = { density = 1, elastic = { E = 1 } } } } }
