-- expect: 03_misspelt_parameter.lua:8 key=etta nearest=eta
local s = require "sunder"
local matter = {
  density = 1,
  elastic = { E = 1 },
  damage = {
    break_stretch = 0.1,
    etta = 0.2,
  },
}
return s.scene { particles = 1000, solids = { { shape = s.sphere { radius = 1 }, material = matter } } }
