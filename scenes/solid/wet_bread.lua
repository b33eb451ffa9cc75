-- Wet bread: a stick of bread with a notch on its left, water dripping on its right, pulled apart. Dry, it tears at the notch;
-- wet, where the water went.
--
-- Source: METHOD.md, end of section 6: moisture in solids that softens them and swells them, which neither paper has.
--
-- What to look for: the water spreads through the crumb, which swells and gives under it, and the notch stays shut.
--
-- Try:  sunder run scenes/solid/wet_bread.lua --set water=0                      dry: it tears at the notch
--       sunder run scenes/solid/wet_bread.lua --set strength=0 --set stiffness=0   water that only swells
local s = require "sunder"

local p = s.params {
  particles = 60000,
  duration  = { 2.5, unit = "time", doc = "a second of dripping, then the pull" },
  fps       = 24,
  water     = { 1, unit = "1", doc = "moisture that the drop holds; 0: dry", min = 0 },
  pull      = { 0.05, unit = "length/time", doc = "speed of each grip", min = 0 },
}

local half, thick = 0.5, 0.12

local function grip(side)
  local from, to = side * (half - 0.06), side * (half + 1)
  return { name = side < 0 and "left" or "right", start = 1, velocity = { side * p.pull, 0, 0 },
           shape = s.box { min = { math.min(from, to), -1, -1 }, max = { math.max(from, to), 1, 1 } } }
end

return s.scene {
  title        = "Wet bread",
  particles_per_cell = 8,
  mass_damping = 1,
  solids = { {
    name     = "stick",
    shape    = s.box { min = { -half, -thick, -thick }, max = { half, thick, thick } },
    material = s.recipe "bread",
    notches  = { s.box { min = { -0.22, thick - 0.07, -1 }, max = { -0.18, 1, 1 } } },
    sources  = p.water > 0 and { { shape = s.sphere { center = { 0.2, thick, 0 }, radius = 0.16 }, value = p.water } } or {},
  } },
  grips = { grip(-1), grip(1) },
}
