-- expect: 33_infinite.lua:5 key=solids[1].velocity says inf
local s = require "sunder"
return s.scene { particles = 1000, solids = { {
  shape = s.sphere { radius = 1 },
  velocity = { 0, math.huge, 0 },
  material = { density = 1, elastic = { E = 1 } } } } }
