-- Contact of a sheet and a solid: blows, edges, crowds, and from within.
--
--   shot     a ball at a free film, at the speed of its waves
--   bullet   the same, three times as fast
--   inside   a film that starts inside a ball
--   stiff    the same, a film whose steps are thirty times shorter than the ball's
--   edge     a film that falls over the edge of a held block, and folds around it
--   many     a film held along two sides under nine balls
--   crowd    a ball of 200 particles a cell: a film's particle has some hundreds in reach
local s = require "sunder"
local p = s.params { duration = 0.05, fps = 100, dx = 0.05, variant = s.choice { "shot", "bullet", "inside", "stiff", "edge", "many", "crowd" } }
local v = p.variant
local within = v == "inside" or v == "stiff"
local speed = ({ shot = 10, crowd = 10, bullet = 30, many = 2 })[v]
local soft = { density = 10, elastic = { E = 1000, nu = 0.3 } }
local cloth = { density = 100, linear = { E = v == "stiff" and 1e7 or 1e4 } }

local function ball(x, y, z, radius)
  return { shape = s.sphere { center = { x, y, z }, radius = radius }, velocity = speed and { 0, 0, -speed } or nil, material = soft }
end
local function balls()
  local all = {}
  for i = -1, 1 do
    for j = -1, 1 do all[#all + 1] = ball(0.2 * i, 0.2 * j, 0.13 + 0.01 * (i + j), 0.08) end
  end
  return all
end

local solids = v == "many" and balls() or { ball(0, 0, within and 0.08 or 0.25, 0.2) }
local grips
if v == "edge" then
  solids = { { shape = s.box { min = { -0.4, -0.25, -0.35 }, max = { 0, 0.25, -0.05 } }, material = { density = 100, elastic = { E = 1e4, nu = 0.3 } } } }
  grips = { { shape = s.box { min = { -1, -1, -1 }, max = { -0.1, 1, -0.15 } } } }
elseif v == "many" then
  grips = { { shape = s.box { min = { -1, -1, -0.01 }, max = { -0.27, 1, 0.01 } } }, { shape = s.box { min = { 0.27, -1, -0.01 }, max = { 1, 1, 0.01 } } } }
end

return s.scene {
  title    = "Contact of both kinds",
  contact  = 0.5,
  duration = (v == "edge" or v == "many") and 0.4 or p.duration,
  gravity  = v == "edge" and { 0, 0, -10 } or nil,
  particles_per_cell = v == "crowd" and 200 or nil,
  solids   = solids,
  sheets   = { { shape = s.rectangle { size = { 0.6, 0.6 } }, thickness = 0.02, spacing = 0.03, material = cloth } },
  grips    = grips,
  expect   = { momentum_drift = 1e-4, energy_gain = not within and 0.02 or nil, speed_max = within and 3 or speed and 4 * speed or 60,
               determinant_min = v ~= "bullet" and 0.1 or nil, low_z = v == "edge" and -0.6 or v == "many" and -0.2 or nil },
}
