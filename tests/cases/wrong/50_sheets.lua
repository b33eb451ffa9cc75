-- expect: 50_sheets.lua:4 key=sheets says solids
local s = require "sunder"
return s.scene { particles = 1000,
  sheets = { {} },
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
}
