-- expect: 16_runtime_error.lua:4 says arithmetic on a nil value
local s = require "sunder"
local speed
local twice = 2 * speed
return s.scene {}
