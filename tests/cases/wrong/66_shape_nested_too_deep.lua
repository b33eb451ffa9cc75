-- expect: 66_shape_nested_too_deep.lua:6 key=union says nested at most
local s = require "sunder"
local ball = s.sphere { radius = 1 }
local pile = ball
for i = 1, 300 do
  pile = s.union(pile, ball)
end
return s.scene { particles = 1000, solids = { { shape = pile, material = { density = 1, elastic = { E = 1 } } } } }
