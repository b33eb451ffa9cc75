-- Paper towel: a towel torn from a nick in its upper edge.
--
-- Source: sheet paper (Han, Xue, Aanjaneya), Fig. 8 and section 6.3.
--
--   variant   water             what to look for
--   dry       none              a clean tear along the grain
--   wet       patches of it     an irregular tear that goes where the towel is wet
local s = require "sunder"

local p = s.params {
  dx = 0.04, -- 2 500 particles
  duration = 1.2,
  fps = 60,
  pull = { 0.12, unit = "length/time", doc = "speed of each side", min = 0 },
  rate = { 0.6, unit = "1/time", doc = "of water in a patch", min = 0 },
  patches = { 12, doc = "how many", min = 0 },
  seed = 1,
  variant = s.choice { "dry", "wet" },
}

local water = { diffusion = { k = 0.5, C = 1 }, swelling = 0.05, softening = { stiffness = 1.5, toughness = 2.5, floor = 0.05 } }
local wet = p.variant == "wet"

local function grip(side)
  return { name = side < 0 and "left" or "right", velocity = { side * p.pull, 0, 0 },
           shape = s.box { center = { side * 1.02, 0, 0 }, size = { 0.2, 3, 3 } } }
end

return s.scene {
  title = "Paper towel",
  sheets = { { shape = s.rectangle { size = { 2, 2 } }, thickness = 0.04, material = s.recipe("paper_towel", wet and water or {}),
               grain = s.fibres.direction { 0, 1, 0 },
               notches = { { from = { 0, 0.7, 0 }, to = { 0, 1.1, 0 } } },
               sources = wet and { { spots = p.patches, radius = 0.2, rate = p.rate, stop = 0.5 } } or nil } },
  grips = { grip(-1), grip(1) },
}
