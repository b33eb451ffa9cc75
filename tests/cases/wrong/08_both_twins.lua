-- expect: 08_both_twins.lua:6 key=damage.sigma_c found=both
local s = require "sunder"
local matter = {
  density = 1,
  elastic = { E = 1 },
  damage = { sigma_c = 1, break_stretch = 0.1 },
}
return s.scene { particles = 1000, solids = { { shape = s.sphere { radius = 1 }, material = matter } } }
