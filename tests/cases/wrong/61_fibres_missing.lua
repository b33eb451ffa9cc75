-- expect: 61_fibres_missing.lua:3 key=fibres says fibre directions
local s = require "sunder"
return s.scene { particles = 1000, solids = { { shape = s.sphere { radius = 1 }, material = s.recipe "tube" } } }
