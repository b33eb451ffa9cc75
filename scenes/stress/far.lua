-- Far: two blocks that collide, at the origin and a million cells away from it. Positions are kept from their block's first node, so what
-- happens is the same; in f32 the places written to frames are only as fine as the distance lets them be.
local s = require "sunder"
local p = s.params { duration = 0.2, fps = 50, dx = 0.1, variant = s.choice { "origin", "far" } }
local at = p.variant == "far" and 65536 or 0 -- a power of two, and of cells: 655 360

local function block(side)
  local x = at + 0.25 * side
  return { shape = s.box { min = { x - 0.2, -0.2, at - 0.2 }, max = { x + 0.2, 0.2, at + 0.2 } }, sampling = "lattice", velocity = { -2 * side, 0, 0 },
           material = { density = 1, elastic = { E = 1000, nu = 0.3 } } }
end

return s.scene {
  title  = "Far",
  solids = { block(-1), block(1) },
  expect = { energy_gain = 0.02, momentum_drift = 1e-5, determinant_min = 0.5, determinant_max = 1.5, speed_max = 5,
             same_as = at > 0 and { variant = "origin", shift = { at, 0, at }, tolerance = 0.02 } or nil },
}
