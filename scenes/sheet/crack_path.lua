-- Crack path: a notched brittle sheet under tension; two sources ahead of the crack draw it off its straight way.
--
-- Source: sheet paper (Han, Xue, Aanjaneya), Fig. 2 and section 6.2, Table 1 second column.
--
--   variant   sources   what to look for
--   dry       none      a straight crack, mirror-symmetric
--   wet       two       a crack that turns to the source above its way, then to the one below
--
-- Table 1's alpha = 1 with quantities of a few per cent. What diffuses also takes toughness away (acid dissolves, water weakens).
local s = require "sunder"

local p = s.params {
  dx = 0.02, -- 10 000 particles
  duration = 4,
  fps = 50,
  strain_rate = { 0.01, unit = "1/time", doc = "of the sheet, from both grips", min = 0 },
  rate = { 0.008, unit = "1/time", doc = "of each source", min = 0 },
  offset = { 0.15, unit = "length", doc = "of the sources from the notch's line" },
  R = { 1.5, unit = "spacings", doc = "reach of bonds", min = 1.2, max = 5 },
  variant = s.choice { "dry", "wet" },
}

local material = {
  density = 5000,
  linear = { E = 2e4, nu = 0.3, poisson = "bond" },
  fracture = { G = 11.3 },
}
local sources
if p.variant == "wet" then
  material.diffusion = { k = 0.01, C = 1 }
  material.swelling = 1
  material.softening = { toughness = 40 }
  local function spot(x, y) return { shape = s.sphere { center = { x, y, 0 }, radius = 0.12 }, rate = p.rate } end
  sources = { spot(0.05, p.offset), spot(0.6, -p.offset) }
end

local function grip(side)
  return { name = side < 0 and "bottom" or "top", velocity = { 0, side * p.strain_rate, 0 },
           shape = s.box { center = { 0, side * 1.02, 0 }, size = { 3, 0.16, 3 } } }
end

return s.scene {
  title = "Crack path",
  sheets = { { shape = s.rectangle { size = { 2, 2 } }, thickness = 0.02, radius = p.R, material = material, sources = sources,
               notches = { { from = { -1.1, 0, 0 }, to = { -0.3, 0, 0 } } } } },
  grips = { grip(-1), grip(1) },
}
