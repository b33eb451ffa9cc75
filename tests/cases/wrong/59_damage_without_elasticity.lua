-- expect: 59_damage_without_elasticity.lua:4 key=damage says elastic
local s = require "sunder"
return s.scene { particles = 1000, solids = { { shape = s.sphere { radius = 1 },
  material = { density = 1, damage = { sigma_c = 1 } } } } }
