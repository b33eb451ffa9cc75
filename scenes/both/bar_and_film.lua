-- Bar and film: a solid bar and a film before it, drawn apart by the same two grips: one clock, one ledger row, one frame for both.
--
-- Source: none; it shows a scene of both kinds (DESIGN.md, "A frame holds /solid and /sheet").
--
--   kind    what to look for
--   both    the bar necks and holds; the film, which has a notch, tears across
--   solid   the bar alone: with the same dt its places are the same to the bit
--   sheet   the film alone, likewise
--
-- Solids and sheets share time, gravity, grips and colliders, but pass through one another: they do not touch. So the film hangs a little before the bar.
local s = require "sunder"

local p = s.params {
  particles = 6000,
  duration  = { 1.5, unit = "time", doc = "36 frames" },
  fps       = 24,
  dt        = { 5e-4, unit = "time", doc = "of both, so that they may be compared with runs of one alone" },
  pull      = { 0.12, unit = "length/time", doc = "speed of each grip", min = 0 },
  kind      = s.choice { "both", "solid", "sheet" },
}

local bar = { name = "bar", shape = s.box { min = { -1, -0.2, -0.2 }, max = { 1, 0.2, 0.2 } },
              material = { density = 500, elastic = { E = 4e4, nu = 0.4 } } }

local film = { name = "film", shape = s.rectangle { size = { 2, 0.8 } }, point = { 0, 0, 0.4 }, thickness = 0.02, spacing = 0.02,
               material = { density = 500, linear = { E = 4e4 }, fracture = { stretch = 0.12 }, damping = 1 },
               notches = { { from = { 0, 0.2, 0.4 }, to = { 0, 1, 0.4 } } } }

local function grip(side)
  return { name = side < 0 and "left" or "right", velocity = { side * p.pull, 0, 0 },
           shape = s.box { center = { side * 1.0, 0, 0.1 }, size = { 0.2, 2, 2 } } }
end

return s.scene {
  title = "Bar and film",
  solids = p.kind ~= "sheet" and { bar } or nil,
  sheets = p.kind ~= "solid" and { film } or nil,
  grips = { grip(-1), grip(1) },
}
