-- expect: circle.lua:2 key=recipe says do not need each other
local s = require "sunder"
return s.scene { particles = 1000, solids = { { shape = s.sphere { radius = 1 }, material = s.recipe "circle" } } }
