-- expect: 38_velocity_writes_table.lua:5 key='last' says pure
local s = require "sunder"
local memory = { last = 0 }
local function velocity(t)
  memory.last = t
  return 0, 0, memory.last
end
return s.scene { particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
  grips = { { shape = s.sphere { radius = 0.5 }, velocity = velocity } } }
