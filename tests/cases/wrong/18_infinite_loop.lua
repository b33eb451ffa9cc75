-- expect: 18_infinite_loop.lua:3 says processor time
local s = require "sunder"
while true do end
