-- expect: 86_endless_step.lua:4 key=dt says steps a frame
local s = require "sunder"
return s.scene { particles = 1000, fps = 24,
  dt = 1e-30,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
}
