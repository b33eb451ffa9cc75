-- expect: 48_undeclared_parameter.lua:4 key=pul nearest=pull
local s = require "sunder"
local p = s.params { pull = 0.1 }
return s.scene { duration = p.pul }
