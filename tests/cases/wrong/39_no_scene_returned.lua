-- expect: 39_no_scene_returned.lua:4 found=a_table says s.scene
local s = require "sunder"
local scene = { particles = 1000 }
return scene
