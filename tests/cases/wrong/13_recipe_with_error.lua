-- expect: broken.lua:3 key=elastic.E found='hard'
local s = require "sunder"
return s.scene { particles = 1000, solids = { { shape = s.sphere { radius = 1 }, material = s.recipe "broken" } } }
