-- expect: 46_misspelt_function.lua:3 key=spere nearest=sphere
local s = require "sunder"
return s.scene { solids = { { shape = s.spere { radius = 1 } } } }
