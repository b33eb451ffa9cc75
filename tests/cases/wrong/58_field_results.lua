-- expect: 58_field_results.lua:4 key=field says 4 results
local s = require "sunder"
return s.scene { particles = 1000, solids = { { shape = s.sphere { radius = 1 },
  fibres = s.fibres.field(function(x, y, z) return x, y, z, 1 end),
  material = { density = 1, elastic = { E = 1 }, fibres = true } } } }
