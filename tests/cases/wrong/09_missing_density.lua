-- expect: 09_missing_density.lua:5 key=density found=nothing
local s = require "sunder"
return s.scene {
  particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { elastic = { E = 1 } } } },
}
