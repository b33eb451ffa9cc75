-- expect: 27_load_of_binary.lua:4 says binary
local s = require "sunder"
local chunk = "\27Lua" .. ("\0"):rep(20)
local run = assert(load(chunk, "chunk", "b"))
return run()
