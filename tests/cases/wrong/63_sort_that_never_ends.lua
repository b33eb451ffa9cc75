-- expect: 63_sort_that_never_ends.lua:3 says processor time
local s = require "sunder"
table.sort({ 3, 1, 2 }, function() while true do end end)
return s.scene {}
