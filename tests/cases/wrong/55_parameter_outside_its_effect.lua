-- expect: 55_parameter_outside_its_effect.lua:3 key=eta nearest=damage.eta
local s = require "sunder"
return s.scene { particles = 1000, solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, eta = 0.1, elastic = { E = 1 } } } } }
