-- expect: 17_error_in_nested_function.lua:3 says attempt to index a number value
local s = require "sunder"
local function depth(t) return t.inner.value end
local function outer(t) return (depth(t)) end
return s.scene { duration = (outer { inner = 3 }), }
