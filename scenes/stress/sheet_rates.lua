-- Rates: multi-rate steps where stiffness jumps, with cracks and heat.
--
--   step    E changes by 1e6 in the middle: as many levels as there are
--   crack   a notched sheet that tears, halved where bonds break
--   heated  a hot spot that swells
local s = require "sunder"
local p = s.params { duration = 0.1, fps = 50, dx = 0.1, variant = s.choice { "step", "crack", "heated" } }
local v = p.variant
local E = v == "step" and 1e7 or 1e5
local matter = { density = 1000, linear = { E = E }, damping = { rate = 1 }, multirate = { levels = 5 } }
local soft = { density = 1000, linear = { E = 10 }, multirate = { levels = 5 } }
if v == "crack" then matter.fracture = { G = 1 } end
if v == "heated" then matter.diffusion, matter.swelling = { k = 1000, C = 1 }, 0.1 end
local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.21, 9, 9 } }, velocity = { v ~= "heated" and 0.2 * side or 0, 0, 0 } }
end

return s.scene {
  title  = "Sheet rates",
  sheets = v == "step" and { { shape = s.rectangle { size = { 1, 0.6 } }, thickness = 0.01, spacing = 0.05, material = matter },
                             { shape = s.rectangle { size = { 1, 0.6 }, center = { 0, 0, 0 } }, point = { 0, 0, 0.2 }, thickness = 0.01, spacing = 0.05, material = soft } }
        or { { shape = s.rectangle { size = { 1, 0.6 } }, thickness = 0.01, spacing = 0.05, material = matter,
               notches = v == "crack" and { { from = { 0, -0.4, 0 }, to = { 0, 0, 0 } } } or nil,
               sources = v == "heated" and { { shape = s.sphere { radius = 0.15 }, value = 1 } } or nil } },
  grips  = { grip(-1), grip(1) },
  expect = { energy_gain = v ~= "heated" and 0.02 or nil, speed_max = 20, spread = 2 },
}
