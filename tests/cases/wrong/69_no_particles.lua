-- expect: 69_no_particles.lua:3 key=particles found=nothing
local s = require "sunder"
return s.scene {
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
}
