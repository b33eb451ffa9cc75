-- Nonlocal: the notched sheet of crack_path.lua, with bonds that reach further and further.
--
-- Source: sheet paper (Han, Xue, Aanjaneya), Fig. 11 and section 6.6: R = 0.0681, 0.0749, 0.0851, 0.0953, 0.102 at dx = 0.02.
-- What to look for: with the larger R the crack is slower, and the sheet holds more while it runs. Before that the
-- sheets are equally stiff: the stiffness of bonds is calibrated, so that E is what is asked for at any R.
--
--   variant   what is in it
--   dry       nothing
--   wet       one source beside the crack's way
local s = require "sunder"

local p = s.params {
  dx = 0.02, -- 10 000 particles
  duration = 4,
  fps = 50,
  R = { 0.0681, unit = "length", doc = "reach of bonds", min = 0.024, max = 0.1 * 5 },
  strain_rate = { 0.012, unit = "1/time", doc = "of the sheet, from both grips", min = 0 },
  variant = s.choice { "dry", "wet" },
}

local material = {
  density = 5000,
  linear = { E = 2e4, nu = 0.3, poisson = "bond" },
  fracture = { G = 11.3 },
}
if p.variant == "wet" then
  material.diffusion = { k = 0.01, C = 1 }
  material.swelling = 1
end

local function grip(side)
  return { name = side < 0 and "bottom" or "top", velocity = { 0, side * p.strain_rate, 0 },
           shape = s.box { center = { 0, side * 1.02, 0 }, size = { 3, 0.24, 3 } } }
end

return s.scene {
  title = "Nonlocal",
  sheets = { { shape = s.rectangle { size = { 2, 2 } }, thickness = 0.02, radius = p.R / p.dx, material = material,
               notches = { { from = { -1.1, 0, 0 }, to = { -0.3, 0, 0 } } },
               sources = p.variant == "wet" and { { shape = s.sphere { center = { 0, 0.2, 0 }, radius = 0.15 }, rate = 0.05 } } or nil } },
  grips = { grip(-1), grip(1) },
}
