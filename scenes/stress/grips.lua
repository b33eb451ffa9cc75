-- Grips: motions that no machine makes.
--
--   cross   two grips pass through each other
--   spin    one end of a bar is turned at high speed
--   jerk    a grip stops within no time, and goes back at once
--   sudden  a grip that starts at twenty times the speed of waves
--   same    two grips hold the same nodes and want different things
local s = require "sunder"
local p = s.params { duration = 0.3, fps = 40, dx = 0.1, variant = s.choice { "cross", "spin", "jerk", "sudden", "same" } }
local v = p.variant
local function box(x) return s.box { center = { x, 0, 0 }, size = { 0.2, 9, 9 } } end
local grips = {
  cross = { { shape = box(-0.5), velocity = { 5, 0, 0 } }, { shape = box(0.5), velocity = { -5, 0, 0 } } },
  spin  = { { shape = box(-0.5) }, { shape = box(0.5), spin = { 60, 0, 0 } } },
  jerk  = { { shape = box(-0.5) }, { shape = box(0.5), velocity = function(t) return t < 0.1 and 5 or t < 0.2 and 0 or -5, 0, 0 end } },
  sudden = { { shape = box(-0.5) }, { shape = box(0.5), velocity = { 700, 0, 0 }, start = 0.1, stop = 0.11 } },
  same  = { { shape = box(0.5), velocity = { 2, 0, 0 } }, { shape = box(0.5), velocity = { -2, 0, 0 } }, { shape = box(-0.5) } },
}

return s.scene {
  title  = "Grips",
  solids = { { shape = s.box { size = { 1, 0.3, 0.3 }, center = { 0, 0, 0 } }, material = { density = 1, elastic = { E = 1000, nu = 0.3 } } } },
  grips  = grips[v],
  expect = { energy_gain = 0.02, speed_max = v == "sudden" and 1500 or 100, determinant_max = 50 },
}
