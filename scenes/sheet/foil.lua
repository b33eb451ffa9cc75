-- Foil: aluminium foil torn by hand: the two halves of its upper edge are moved apart out of the plane.
--
-- Source: sheet paper (Han, Xue, Aanjaneya), Fig. 4 and section 6.3, Table 1 third column.
--
--   variant   heat                      what to look for
--   dry       none                      a clean tear down the middle, the same on both sides
--   wet       100 spots that are hot    a tear that wanders, because thermal stress adds to that of the pull
local s = require "sunder"

local p = s.params {
  dx = 0.04, -- 2 500 particles
  duration = 8,
  fps = 20,
  pull = { 0.12, unit = "length/time", doc = "speed of each half, out of the plane", min = 0 },
  rate = { 0.1, unit = "1/time", doc = "of heating in a spot", min = 0 },
  spots = { 100, doc = "how many are heated", min = 0 },
  seed = 1,
  variant = s.choice { "dry", "wet" },
}

local heat = { diffusion = { k = 0.3, C = 1 }, swelling = 0.3, softening = { stiffness = 0.3, stretch = 0.5 } }
local hot = p.variant == "wet"

local function grip(side)
  return { name = side < 0 and "left" or "right", velocity = { side * 0.5 * p.pull, 0.1 * p.pull, side * p.pull },
           shape = s.box { center = { side * 0.53, 1.0, 0 }, size = { 0.94, 0.16, 3 } } }
end

return s.scene {
  title = "Foil",
  sheets = { { shape = s.rectangle { size = { 2, 2 } }, thickness = 0.04, material = s.recipe("foil", hot and heat or {}),
               notches = { { from = { 0, 0.7, 0 }, to = { 0, 1.1, 0 } } },
               sources = hot and { { spots = p.spots, radius = 0.08, rate = p.rate, stop = 3 } } or nil } },
  grips = { grip(-1), grip(1), { name = "bottom", shape = s.box { center = { 0, -1, 0 }, size = { 3, 0.1, 3 } } } },
}
