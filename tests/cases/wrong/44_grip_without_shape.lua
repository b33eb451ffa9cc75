-- expect: 44_grip_without_shape.lua:5 key=grips[1].shape found=nothing
local s = require "sunder"
return s.scene { particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
  grips = { { velocity = { 1, 0, 0 } } } }
