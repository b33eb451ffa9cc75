-- expect: 31_coroutines.lua:4 key=coroutine says sandbox
local s = require "sunder"
local function nest(n)
  return coroutine.wrap(function() return nest(n + 1) end)()
end
return s.scene { duration = (nest(1)) }
