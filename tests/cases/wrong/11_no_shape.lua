-- expect: 11_no_shape.lua:5 key=solids[1].shape found=nothing
local s = require "sunder"
return s.scene {
  particles = 1000,
  solids = { { material = { density = 1, elastic = { E = 1 } } } },
}
