-- expect: 64_handler_that_never_ends.lua:4 says processor time
local s = require "sunder"
local function fail() error "first" end
local function handle() while true do end end
while true do xpcall(fail, handle) end
