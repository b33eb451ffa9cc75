-- expect: 25_memory_bomb_in_pcall.lua:5 says MiB of memory
local s = require "sunder"
local function swallow()
  local t = {}
  for i = 1, 1e9 do t[i] = { i } end
end
while true do pcall(swallow) end
