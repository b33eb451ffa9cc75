-- expect: 36_velocity_writes_global.lua:4 key='calls' says pure
local s = require "sunder"
calls = 0
local function velocity(t) calls = calls + 1 return 0, 0, calls end
return s.scene { particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
  grips = { { shape = s.sphere { radius = 0.5 }, velocity = velocity } } }
