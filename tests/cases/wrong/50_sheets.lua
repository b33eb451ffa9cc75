-- expect: 50_sheets.lua:5 key=sheets[1].lattice nearest=hexagonal found=hexagnal
local s = require "sunder"
return s.scene { particles = 1000,
  sheets = { { shape = s.rectangle { size = { 1, 1 } }, thickness = 0.1, material = { density = 1, linear = { E = 1 } },
    lattice = "hexagnal" } },
}
