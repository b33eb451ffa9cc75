-- expect: 77_module_written_later.lua:8 key='count' says pure
local s = require "sunder"
require "lib/shared"
return s.scene { particles = 1000,
  solids = { { shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
  grips = { { shape = s.sphere { radius = 0.5 }, velocity = function(t)
    local shared = require "lib/shared"
    shared.count = shared.count + 1
    return shared.count, 0, 0
  end } } }
