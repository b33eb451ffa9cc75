-- expect: 22_gsub_bomb.lua:5 says processor time
local s = require "sunder"
local text = ("ab"):rep(20000)
while true do
  text = text:gsub("(.-)(.-)(.-)x", "%1%2%3")
end
