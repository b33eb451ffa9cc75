-- expect: 47_undefined_global.lua:3 key=maht nearest=math
local s = require "sunder"
local half_turn = maht.pi
return s.scene { duration = half_turn }
