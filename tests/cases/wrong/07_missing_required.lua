-- expect: 07_missing_required.lua:4 key=elastic.E found=nothing
local s = require "sunder"
return s.scene { particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { nu = 0.3 } } } } }
