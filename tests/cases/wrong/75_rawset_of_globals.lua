-- expect: 75_rawset_of_globals.lua:3 says read-only
local s = require "sunder"
rawset(_G, "gravity", 9.81)
return s.scene {}
