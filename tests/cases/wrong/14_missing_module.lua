-- expect: 14_missing_module.lua:3 key=require says helpers.lua
local s = require "sunder"
local helpers = require "helpers"
return helpers.scene()
