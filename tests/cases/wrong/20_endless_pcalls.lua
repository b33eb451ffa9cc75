-- expect: 20_endless_pcalls.lua:3 says processor time
local s = require "sunder"
while true do pcall(function() while true do end end) end
