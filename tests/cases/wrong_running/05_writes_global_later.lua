-- expect: 05_writes_global_later.lua:6 key='seen' says pure
local s = require "sunder"
-- Loads: functions of time are tried at seventeen times, and none of these lies between 0.40 and 0.41.
return s.scene { particles = 1000, duration = 1,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1e4 } } } },
  grips = { { shape = s.sphere { radius = 0.5 }, velocity = function(t) if t > 0.40 and t < 0.41 then seen = t end return 0, 0, 0 end } } }
