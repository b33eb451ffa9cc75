local s = require "sunder"
return s.recipe "circle"
