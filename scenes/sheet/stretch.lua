-- Stretch: a thin square sheet drawn far out at two sides.
--
-- Source: sheet paper (Han, Xue, Aanjaneya), Fig. 3 bottom, Table 1 first column.
-- What to look for: the sheet narrows in the middle; nothing breaks.
--
--   variant   Poisson's ratio
--   dry       0.3, the state-based form
--   wet       the same, swollen by 2 %: it hangs slack before it is taut
local s = require "sunder"

local p = s.params {
  dx = 0.02, -- 10 000 particles
  duration = 1.5,
  fps = 24,
  pull = { 0.5, unit = "length/time", doc = "speed of each grip", min = 0 },
  variant = s.choice { "dry", "wet" },
}

local material = { density = 5000, linear = { E = 2e4, nu = 0.3 } }
if p.variant == "wet" then
  material.diffusion = { k = 0.01, initial = 1 }
  material.swelling = 0.02
end

local function grip(side)
  return { name = side < 0 and "left" or "right", velocity = { side * p.pull, 0, 0 },
           shape = s.box { center = { side * 1.02, 0, 0 }, size = { 0.16, 3, 3 } } }
end

return s.scene {
  title = "Stretched sheet",
  sheets = { { shape = s.rectangle { size = { 2, 2 } }, thickness = 0.02, material = material, ripple = 1e-4 } },
  grips = { grip(-1), grip(1) },
}
