-- expect: 24_table_bomb.lua:4 says too long
local s = require "sunder"
local endless = setmetatable({}, { __len = function() return 1 << 60 end })
table.insert(endless, 1, true)
return s.scene {}
