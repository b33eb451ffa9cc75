-- expect: 06_out_of_range.lua:4 key=elastic.nu found=0.6
local s = require "sunder"
return s.scene { particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1, nu = 0.6 } } } } }
