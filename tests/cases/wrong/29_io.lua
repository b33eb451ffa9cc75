-- expect: 29_io.lua:3 key=io says sandbox
local s = require "sunder"
local file = io.open "/etc/passwd"
return s.scene { title = file:read "a" }
