-- Seaweed: a flake pulled apart abruptly at its sides.
--
-- Source: sheet paper (Han, Xue, Aanjaneya), Fig. 7 and section 6.5, Table 1 fifth column.
--
--   variant       moisture               what to look for
--   crisp (dry)   none                   brittle cracks that branch, the same above and below
--   damp (wet)    drops here and there   cracks that turn and branch without symmetry
local s = require "sunder"

local p = s.params {
  dx = 0.04, -- 2 500 particles
  duration = 1.2,
  fps = 100,
  pull = { 0.12, unit = "length/time", doc = "speed of each side", min = 0 },
  rate = { 0.4, unit = "1/time", doc = "of moisture in a drop", min = 0 },
  drops = { 25, doc = "how many", min = 0 },
  seed = 1,
  variant = s.choice { "crisp", "damp", "dry", "wet" },
}

local moisture = { diffusion = { k = 0.01, C = 1 }, swelling = 0.3, softening = { stiffness = 1.5, toughness = 3 } }
local damp = p.variant == "damp" or p.variant == "wet"

local function grip(side)
  return { name = side < 0 and "left" or "right", velocity = { side * p.pull, 0, 0 },
           shape = s.box { center = { side * 1.02, 0, 0 }, size = { 0.24, 3, 3 } } }
end

return s.scene {
  title = "Seaweed flake",
  sheets = { { shape = s.rectangle { size = { 2, 2 } }, thickness = 0.04, material = s.recipe("seaweed", damp and moisture or {}),
               notches = { { from = { 0, 0.85, 0 }, to = { 0, 1.1, 0 } }, { from = { 0, -0.85, 0 }, to = { 0, -1.1, 0 } } },
               sources = damp and { { spots = p.drops, radius = 0.12, rate = p.rate, stop = 0.5 } } or nil } },
  grips = { grip(-1), grip(1) },
}
