-- expect: 78_notches_of_what_cannot_break.lua:5 key=notches found=notches_in_body_'block' says a material that can break
local s = require "sunder"
return s.scene { particles = 1000, solids = { {
  name = "block", shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } },
  notches = { s.box { size = { 1, 0.2, 1 } } } } } }
