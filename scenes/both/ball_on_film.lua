-- Ball on film: a soft ball falls on a film that is held along two sides. A strong film catches it; a weak one tears, and it goes through.
--
-- Source: none; METHOD.md, end of section 6: sheets and solids in contact, which neither paper has.
--
--   film    what to look for
--   strong  it sags and swings under the ball, and carries it
--   weak    it tears under the ball, which falls on
--   none    without contact the ball falls through as if there were no film
local s = require "sunder"

local p = s.params {
  particles = 6000,
  duration  = { 1.5, unit = "time", doc = "36 frames" },
  fps       = 24,
  friction  = { 0.3, unit = "1", doc = "Coulomb's, between ball and film", min = 0 },
  radius    = { 0.2, unit = "length", doc = "of the ball", min = 0.05 },
  spacing   = { 0.02, unit = "length", doc = "of the film's particles", min = 0.005 },
  film      = s.choice { "strong", "weak", "none" },
}

local cloth = { density = 200, linear = { E = 2e4 }, damping = 1, fracture = { stretch = p.film == "weak" and 0.02 or 0.5 } }

local function grip(side)
  return { name = side < 0 and "left" or "right", shape = s.box { center = { side * 0.6, 0, 0 }, size = { 0.2, 4, 0.1 } }, protects = false }
end

return s.scene {
  title   = "Ball on film",
  gravity = { 0, 0, -4 },
  contact = p.film ~= "none" and { friction = p.friction } or false,
  solids  = { { name = "ball", shape = s.sphere { center = { 0, 0, p.radius + 0.1 }, radius = p.radius },
                material = { density = 100, elastic = { E = 5e3, nu = 0.3 } } } },
  sheets  = { { name = "film", shape = s.rectangle { size = { 1.2, 0.8 } }, thickness = 0.02, spacing = p.spacing, material = cloth } },
  grips   = { grip(-1), grip(1) },
}
