-- Heat: what diffuses in a sheet, too much of it or with no way to go.
--
--   flood         a source of 1e9 a unit of time, without swelling
--   swell         heat that makes the sheet half as long again, with its edges held
--   soften        heat that takes nearly all stiffness and toughness
--   bottleneck    two plates joined by one row of bonds, one of them held hot
--   closed        the same, warm all over and with nothing coming in: nothing may be lost
--   fast          a conductivity of 1e9, which no explicit step follows: it says so
local s = require "sunder"
local p = s.params { duration = 0.2, fps = 50, dx = 0.1, variant = s.choice { "flood", "swell", "soften", "bottleneck", "closed", "fast" } }
local v = p.variant
local matter = { density = 1000, linear = { E = 1e5 }, damping = { rate = 10 }, diffusion = { k = v == "fast" and 1e9 or 1000, C = 1, initial = v == "closed" and 1 or 0 } }
if v == "swell" then matter.swelling = 0.5 end
if v == "soften" then matter.softening = { stiffness = 1, toughness = 1, floor = 1e-6 } matter.fracture = { G = 10 } end
local left, right = s.rectangle { size = { 0.4, 0.4 }, center = { -0.3, 0, 0 } }, s.rectangle { size = { 0.4, 0.4 }, center = { 0.3, 0, 0 } }
local neck = s.rectangle { size = { 0.4, 0.04 }, center = { 0, 0.025, 0 } }
local source = v == "flood" and { shape = s.sphere { radius = 0.1 }, rate = 1e9 } or v == "closed" and nil or v == "bottleneck" and { shape = left, value = 1 } or { shape = s.sphere { radius = 0.1 }, value = 1 }

local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.21, 9, 9 } }, velocity = { v == "soften" and 0.1 * side or 0, 0, 0 } }
end

return s.scene {
  title   = "Sheet heat",
  sheets  = { { shape = (v == "bottleneck" or v == "closed") and left + right + neck or s.rectangle { size = { 1, 0.6 } }, thickness = 0.01, spacing = 0.05, ripple = v == "swell" and 0.01 or 0, material = matter,
                sources = source and { source } or nil } },
  grips   = { grip(-1), grip(1) },
  expect  = v == "fast" and { stop = "diffusion" }
         or v == "flood" and { diffused_min = -1e-3, diffused_max = 1e9, speed_max = 1e-3 }
         or v == "closed" and { diffused_drift = 1e-5, diffused_min = 0.9999, diffused_max = 1.0001, speed_max = 1e-3 }
         or { diffused_min = -1e-5, diffused_max = 1.0001, speed_max = 20, spread = 2 },
}
