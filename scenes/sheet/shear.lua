-- Shear: a thin square sheet whose sides are moved along themselves, and fold it.
--
-- Source: sheet paper (Han, Xue, Aanjaneya), Fig. 3 top, Table 1 first column.
-- What to look for: parallel folds along the drawn diagonal: the sheet has nothing against bending, and presses together across it.
--
--   variant   what is in it
--   dry       nothing
--   wet       swollen by 2 %: deeper folds
local s = require "sunder"

local p = s.params {
  dx = 0.02, -- 10 000 particles
  duration = 1.5,
  fps = 24,
  pull = { 0.5, unit = "length/time", doc = "speed of each grip", min = 0 },
  seed = 1,
  variant = s.choice { "dry", "wet" },
}

local material = { density = 5000, linear = { E = 2e4, nu = 0.3 } }
if p.variant == "wet" then
  material.diffusion = { k = 0.01, initial = 1 }
  material.swelling = 0.02
end

local function grip(side)
  return { name = side < 0 and "left" or "right", velocity = { 0, side * p.pull, 0 },
           shape = s.box { center = { side * 1.02, 0, 0 }, size = { 0.16, 3, 3 } } }
end

return s.scene {
  title = "Sheared sheet",
  sheets = { { shape = s.rectangle { size = { 2, 2 } }, thickness = 0.02, material = material, ripple = 1e-2 } },
  grips = { grip(-1), grip(1) },
}
