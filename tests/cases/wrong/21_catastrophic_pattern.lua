-- expect: 21_catastrophic_pattern.lua:4 says processor time
local s = require "sunder"
local text = ("a"):rep(5000)
local found = text:find(".-.-.-.-.-.-b")
return s.scene { particles = found }
