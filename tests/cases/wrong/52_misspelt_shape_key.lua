-- expect: 52_misspelt_shape_key.lua:4 key=radiu nearest=radius
local s = require "sunder"
local ball = s.sphere {
  radiu = 1 }
return s.scene { particles = 1000, solids = { { shape = ball, material = { density = 1, elastic = { E = 1 } } } } }
