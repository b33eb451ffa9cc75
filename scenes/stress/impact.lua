-- Impact: faster than waves travel.
--
--   wall        a block into a wall, at the speed of waves
--   supersonic  the same at three times that speed
--   disks       disk against disk, each at the speed of waves
--   brittle     the same disks, with damage
local s = require "sunder"
local p = s.params { duration = 0.05, fps = 200, dx = 0.05, variant = s.choice { "wall", "supersonic", "disks", "brittle" } }
local v, speed = p.variant, p.variant == "supersonic" and 105 or 35
local matter = { density = 1, elastic = { E = 1000, nu = 0.3 }, damage = v == "brittle" and { break_stretch = 0.1, eta = 0.001 } or nil }

local function disk(side)
  return { shape = s.cylinder { axis = "z", radius = 0.25, length = 0.15, center = { 0.27 * side, 0, 0 } }, velocity = { -speed * side, 0, 0 }, material = matter }
end
local block = { shape = s.box { min = { -0.2, 0.01, -0.1 }, max = { 0.2, 0.41, 0.1 } }, velocity = { 0, -speed, 0 }, material = matter }
local wall = v == "wall" or v == "supersonic"

return s.scene {
  title  = "Impact",
  solids = wall and { block } or { disk(-1), disk(1) },
  walls  = wall and { { point = { 0, 0, 0 }, normal = "y", contact = "separate" } } or nil,
  expect = { energy_gain = 0.02, momentum_drift = wall and 0.02 or 1e-4, speed_max = 6 * speed, low_y = wall and -0.06 or nil },
}
