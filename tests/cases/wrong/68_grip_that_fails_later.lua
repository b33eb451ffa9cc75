-- expect: 68_grip_that_fails_later.lua:5 says too late
local s = require "sunder"
return s.scene { particles = 1000, duration = 3,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
  grips = { { shape = s.sphere { radius = 0.5 }, velocity = function(t) if t > 2 then error "too late" end return t, 0, 0 end } } }
