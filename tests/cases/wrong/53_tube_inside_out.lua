-- expect: 53_tube_inside_out.lua:6 key=inner found=2
local s = require "sunder"
local tube = s.tube {
  axis = "x", length = 1,
  outer = 1,
  inner = 2,
}
return s.scene { particles = 1000, solids = { { shape = tube, material = { density = 1, elastic = { E = 1 } } } } }
