-- expect: 05_wrong_type.lua:4 key=duration found='long'
local s = require "sunder"
return s.scene {
  duration = "long",
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
}
