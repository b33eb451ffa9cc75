-- expect: 56_module_above_the_scene.lua:3 key=require says no folders above
local s = require "sunder"
return require "../outside"
