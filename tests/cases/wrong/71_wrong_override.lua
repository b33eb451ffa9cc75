-- expect: 71_wrong_override.lua:5 key=damage.etta nearest=eta
local s = require "sunder"
local matter = s.recipe("tube", {
  elastic = { lame = "paper" },
  damage = { etta = 1 } })
return s.scene { particles = 1000, solids = { { shape = s.sphere { radius = 1 }, fibres = s.fibres.direction { 1, 0, 0 }, material = matter } } }
