-- expect: 01_misspelt_scene_key.lua:5 key=gravty nearest=gravity
local s = require "sunder"
return s.scene {
  particles = 1000,
  gravty = { 0, -1, 0 },
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
}
