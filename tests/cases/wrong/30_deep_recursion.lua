-- expect: 30_deep_recursion.lua:3 says stack overflow
local s = require "sunder"
local function dig(n) return 1 + dig(n + 1) end
return s.scene { duration = dig(0) }
