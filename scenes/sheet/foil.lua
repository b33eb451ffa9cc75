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
  duration = 30,
  fps = 8,
  pull = { 0.06, unit = "length/time", doc = "speed of each half, out of the plane, once it has been gained", min = 0 },
  ramp = { 6, unit = "time", doc = "in which it is gained: foil yields at a tenth of what a sudden pull needs", min = 0.01 },
  rate = { 0.02, unit = "1/time", doc = "of heating in a spot", min = 0 },
  spots = { 100, doc = "how many are heated", min = 0 },
  seed = 1,
  variant = s.choice { "dry", "wet" },
}

local heat = { diffusion = { k = 0.3, C = 1 }, swelling = 0.3, softening = { stiffness = 0.3, stretch = 0.5 } }
local hot = p.variant == "wet"

local function grip(side)
  return { name = side < 0 and "left" or "right", velocity = function(t)
             local v = p.pull * math.min(1, t / p.ramp)
             return 0.3 * side * v, 0.2 * v, side * v
           end,
           shape = s.box { center = { side * 0.53, 1.0, 0 }, size = { 0.94, 0.16, 3 } } }
end

return s.scene {
  title = "Foil",
  sheets = { { shape = s.rectangle { size = { 2, 2 } }, thickness = 0.04, material = s.recipe("foil", hot and heat or {}),
               notches = { { from = { 0, 0.7, 0 }, to = { 0, 1.1, 0 } } },
               sources = hot and { { spots = p.spots, radius = 0.08, rate = p.rate, stop = 6 } } or nil } },
  grips = { grip(-1), grip(1), { name = "bottom", shape = s.box { center = { 0, -1, 0 }, size = { 3, 0.1, 3 } } } },
}
