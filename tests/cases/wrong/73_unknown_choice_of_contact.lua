-- expect: 73_unknown_choice_of_contact.lua:5 key=walls[1].contact nearest=separate
local s = require "sunder"
return s.scene { particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
  walls = { { point = { 0, -1, 0 }, normal = "y", contact = "seperate" } } }
