-- Units: the same impact in metres, in nanometres and in megametres. After scaling, the places are the same.
local s = require "sunder"
local p = s.params { duration = 0.1, fps = 200, variant = s.choice { "metre", "nano", "mega" } }
local length = ({ metre = 1, nano = 1e-9, mega = 1e6 })[p.variant]
local density = ({ metre = 1, nano = 1e15, mega = 1e-9 })[p.variant]
local E = 1000 * density * length ^ 2 -- so that times stay

return s.scene {
  title    = "Units", dx = 0.1 * length,
  gravity  = { 0, -10 * length, 0 },
  solids   = { { shape = s.box { min = { -0.3 * length, 0.05 * length, -0.3 * length }, max = { 0.3 * length, 0.65 * length, 0.3 * length } },
                 velocity = { 0.5 * length, -4 * length, 0 },
                 material = { density = density, elastic = { E = E, nu = 0.3 }, damage = { sigma_c = 0.02 * E, eta = 0.01 } } } },
  walls    = { { point = { 0, 0, 0 }, normal = "y", contact = "separate", friction = 0.2 } },
  expect   = { energy_gain = 0.02, determinant_min = 0.2, broken_fraction = { 0.01, 1 },
               same_as = p.variant ~= "metre" and { variant = "metre", length = length, tolerance = 1e-3 } or nil },
}
