-- expect: 70_string_built_for_ever.lua:4 says strings of at most 16 MiB
local s = require "sunder"
local text = "x"
while true do text = text .. text end
