-- Rubber: a rubbery film with a slit in its upper edge, stretched to both sides.
--
-- Source: sheet paper (Han, Xue, Aanjaneya), Fig. 5 and section 6.4, Table 1 fourth column.
--
--   variant   acid                       what to look for
--   dry       none                       wrinkles along the slit, then a crack from its tip, and the halves spring back
--   wet       sprayed at random places   the film dissolves there and tears anywhere
local s = require "sunder"

local p = s.params {
  dx = 0.04, -- 2 500 particles
  duration = 6,
  fps = 24,
  pull = { 0.2, unit = "length/time", doc = "speed of each side", min = 0 },
  ripple = { 1e-4, unit = "spacings", doc = "random places out of the plane at the start", min = 0 },
  slit = { 0.5, unit = "length", doc = "depth of the slit", min = 0 },
  rate = { 0.02, unit = "1/time", doc = "of acid in a spot", min = 0 },
  spots = { 40, doc = "how many are sprayed", min = 0 },
  seed = 1,
  variant = s.choice { "dry", "wet" },
}

local acid = { diffusion = { k = 1, C = 1 }, swelling = 10, softening = { stiffness = 15, toughness = 20, floor = 0.02 } }
local sprayed = p.variant == "wet"

local function grip(side)
  return { name = side < 0 and "left" or "right", velocity = { side * p.pull, 0, 0 },
           shape = s.box { center = { side * 1, 0, 0 }, size = { 0.1, 3, 3 } } }
end

return s.scene {
  title = "Rubbery film",
  sheets = { { shape = s.rectangle { size = { 2, 2 } }, thickness = 0.04, ripple = p.ripple,
               material = s.recipe("rubber_film", sprayed and acid or {}),
               notches = p.slit > 0 and { { from = { 0, 1 - p.slit, 0 }, to = { 0, 1.1, 0 } } } or nil,
               sources = sprayed and { { spots = p.spots, radius = 0.1, rate = p.rate, stop = 2 } } or nil } },
  grips = { grip(-1), grip(1) },
}
