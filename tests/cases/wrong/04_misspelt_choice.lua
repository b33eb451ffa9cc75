-- expect: 04_misspelt_choice.lua:5 key=elastic.lame nearest=paper
local s = require "sunder"
return s.scene {
  particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1, lame = "papper" } } } },
}
