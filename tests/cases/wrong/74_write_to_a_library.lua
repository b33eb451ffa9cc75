-- expect: 74_write_to_a_library.lua:3 key='find' says read-only
local s = require "sunder"
string.find = nil
return s.scene {}
