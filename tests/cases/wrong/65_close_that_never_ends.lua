-- expect: 65_close_that_never_ends.lua:3 says processor time
local s = require "sunder"
local guard = setmetatable({}, { __close = function() while true do end end })
while true do
  pcall(function() local held <close> = guard error "leave" end)
end
