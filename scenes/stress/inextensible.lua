-- Inextensible: fibres that may not stretch, where that is hard to keep.
--
--   rope       a rope with a weight a thousand times its own, let go at once: it may sink by 0.1 % of the free rope, from -0.3875
--   loop       a ring whose fibres close on themselves, thrown open
--   random     a free block of random directions: more constraints than it has ways to move
--   gripped    a block that two grips pull along its fibres, which cannot be: the tension has no bound
--   wall       thrown against a wall, end on
local s = require "sunder"
local p = s.params { dx = 0.1, variant = s.choice { "rope", "loop", "random", "gripped", "wall" } }
local v = p.variant
local matter = { density = 1, elastic = { E = 100, nu = 0.3 }, inextensible = true }
local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.2, 9, 9 } }, velocity = { side * 0.5, 0, 0 } }
end

local rope = { shape = s.box { min = { -0.15, 0, -0.15 }, max = { 0.15, 1, 0.15 } }, fibres = s.fibres.direction { 0, 1, 0 }, material = matter }
local weight = { shape = s.box { min = { -0.3, -0.4, -0.3 }, max = { 0.3, 0, 0.3 } }, material = { density = 600, elastic = { E = 1e7, nu = 0.3 } } }
local ring = { shape = s.tube { axis = "z", length = 0.3, outer = 0.5, inner = 0.25 }, fibres = s.fibres.circumferential { axis = "z" },
               velocity = function(x, y, z) return 2 * x, -2 * y, 0 end, material = matter }
local thrown = p.variant == "wall" and { 0, -3, 0 } or p.variant == "random" and function(x, y, z) return x, -y, 0 end or nil
local block = { shape = s.box { size = { 1, 0.4, 0.4 }, center = { 0, v == "wall" and 0.6 or 0, 0 } }, velocity = thrown, material = matter,
                fibres = v == "random" and s.fibres.random { direction = "x", spread = 3 } or s.fibres.direction(v == "wall" and { 0, 1, 0 } or { 1, 0, 0 }) }

return s.scene {
  title   = "Inextensible", duration = v == "gripped" and 0.002 or 0.1, fps = v == "gripped" and 1000 or 40, gravity = { 0, v == "rope" and -10 or 0, 0 },
  solids  = v == "rope" and { rope, weight } or v == "loop" and { ring } or { block },
  grips   = v == "rope" and { { shape = s.box { min = { -9, 0.9, -9 }, max = { 9, 2, 9 } } } } or v == "gripped" and { grip(-1), grip(1) } or nil,
  walls   = v == "wall" and { { point = { 0, 0, 0 }, normal = "y", contact = "slip" } } or nil,
  expect  = v == "rope" and { energy_gain = 0.02, low_y = -0.3884, speed_max = 0.3 }
         or v == "gripped" and { speed_max = 30, fibre_stretch_max = 2, determinant_min = 0.1, steps = 50,
                               known_limit = "grips that pull an inextensible fibre at both ends: tension and steps have no bound; docs/stress.md" }
         or { energy_gain = 0.02, speed_max = 30, fibre_stretch_max = 1.05, fibre_stretch_min = v == "random" and 0.5 or 0.9, determinant_min = 0.2 },
}
