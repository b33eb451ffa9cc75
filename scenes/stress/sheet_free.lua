-- Free: a sheet that nothing holds.
--
--   spin           a plate that turns fast in its plane, for many turns
--   tumble         about a diagonal, out of its plane
--   tear           two halves thrown apart: it tears in the middle
--   far            the same, 65 536 lengths away: places are sums of two reals
--   nano, mega     the same in nanometres and megametres
local s = require "sunder"
local p = s.params { variant = s.choice { "spin", "tumble", "tear", "far", "nano", "mega" } }
local v = p.variant
local L = v == "nano" and 1e-9 or v == "mega" and 1e6 or 1
local turns, at = v == "spin" or v == "tumble", v == "far" and 65536 or 0
local rate = 5
local density = 1000 / L ^ 2
local matter = { density = density, linear = { E = 1e5 }, fracture = not turns and { stretch = 0.02 } or nil }
local function velocity(x, y, z)
  if v == "spin" then return -rate * y, rate * x, 0 end
  if v == "tumble" then return rate * 0.7 * z, -rate * 0.7 * z, rate * 0.7 * (y - x) end
  return (x - at > 0.025 * L and 2 or -2) * L, 0, 0
end

return s.scene {
  title    = "Sheet free", duration = turns and 4 or 0.1, fps = turns and 5 or 50, dx = 0.1 * L,
  sheets   = { { shape = s.rectangle { size = { L, 0.6 * L }, center = { at, 0, 0 } }, thickness = 0.01 * L, spacing = 0.05 * L, material = matter, velocity = velocity } },
  expect   = turns and { angular_drift = 1e-3, momentum_drift = 1e-4, energy_gain = 0.01, spread = 1.4, bond_stretch_max = 0.2 }
          or { momentum_drift = 1e-4, energy_gain = 0.01, broken_fraction = { 0.01, 0.9 },
               same_as = v ~= "tear" and { variant = "tear", length = L, shift = { at, 0, 0 }, tolerance = v == "far" and 0.01 or 1e-3 } or nil },
}
