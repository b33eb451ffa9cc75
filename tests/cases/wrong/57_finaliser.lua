-- expect: 57_finaliser.lua:3 says __gc
local s = require "sunder"
setmetatable({}, { __gc = function() while true do end end })
return s.scene {}
