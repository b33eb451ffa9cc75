-- expect: 10_no_solids.lua:3 key=solids found=none
local s = require "sunder"
return s.scene { particles = 1000, gravity = { 0, -1, 0 } }
