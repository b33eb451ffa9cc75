-- expect: 19_infinite_loop_in_pcall.lua:3 says processor time
local s = require "sunder"
pcall(function() while true do end end)
return s.scene { particles = 1 }
