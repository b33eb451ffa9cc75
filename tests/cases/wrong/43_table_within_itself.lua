-- expect: 43_table_within_itself.lua:6 says does not exist
local s = require "sunder"
local matter = { density = 1, elastic = { E = 1 } }
matter.damage = matter
return s.scene { particles = 1000, solids = {
  { shape = s.sphere { radius = 1 }, material = matter } } }
