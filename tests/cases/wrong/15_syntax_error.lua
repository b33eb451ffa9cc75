-- expect: 15_syntax_error.lua:5 says near 'duration'
local s = require "sunder"
return s.scene {
  particles = 1000
  duration = 1,
}
