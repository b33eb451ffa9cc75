-- expect: 62_three_mistakes.lua:6 key=durration nearest=duration
-- expect: 62_three_mistakes.lua:8 key=kernel nearest=cubic
-- expect: 62_three_mistakes.lua:9 key=sampling nearest=lattice
local s = require "sunder"
return s.scene {
  durration = 2,
  particles = 1000,
  kernel = "cubik",
  solids = { { sampling = "latice",
    shape = s.sphere { radius = 1 }, material = { density = 1, elastic = { E = 1 } } } },
}
