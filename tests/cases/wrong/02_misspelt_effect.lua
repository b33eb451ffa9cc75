-- expect: 02_misspelt_effect.lua:8 key=damge nearest=damage
local s = require "sunder"
return s.scene {
  particles = 1000,
  solids = { {
    shape = s.sphere { radius = 1 },
    material = { density = 1, elastic = { E = 1 },
      damge = { break_stretch = 0.1 } },
  } },
}
