-- expect: 40_number_returned.lua:3 found=42
local s = require "sunder"
return 42
