-- expect: 67_inherited_keys.lua:4 key=solids[1].material says metatable
local s = require "sunder"
local base, matter = { density = 1, elastic = { E = 1 } }, {}
return s.scene { particles = 1000, solids = { { shape = s.sphere { radius = 1 }, material = setmetatable(matter, { __index = base }) } } }
