-- expect: 23_rep_bomb.lua:4 says resulting string too large
local s = require "sunder"
local nothing = (""):rep(1e18) -- harmless: no bytes at all
local much = ("x"):rep(1e12)
return s.scene { particles = #nothing + #much }
