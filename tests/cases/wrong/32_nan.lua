-- expect: 32_nan.lua:4 key=dx says nan
local s = require "sunder"
return s.scene { particles = 1000,
  dx = 0 / 0,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
}
