-- expect: 37_velocity_writes_upvalue.lua:4 key=grips[1].velocity says upvalue
local s = require "sunder"
local calls = 0
local function velocity(t) calls = calls + 1 return 0, 0, calls end
return s.scene { particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
  grips = { { shape = s.sphere { radius = 0.5 }, velocity = velocity } } }
