-- expect: 81_misspelt_notches.lua:5 key=solids[1].notch nearest=notches
local s = require "sunder"
return s.scene { particles = 1000, solids = { {
  shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 }, damage = { sigma_c = 1 } },
  notch = { s.sphere { radius = 0.5 } } } } }
