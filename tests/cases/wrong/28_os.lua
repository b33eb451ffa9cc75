-- expect: 28_os.lua:3 key=os says sandbox
local s = require "sunder"
os.execute "true"
return s.scene {}
