-- Contrast: two blocks that touch and press, with very different materials.
--
--   stiffness   one is 1e6 times as stiff as the other
--   density     one is 1e4 times as dense as the other
local s = require "sunder"
local p = s.params { duration = 0.2, fps = 50, dx = 0.1, variant = s.choice { "stiffness", "density" } }
local stiff = p.variant == "stiffness" and { 1e7, 10 } or { 1000, 1000 }
local dense = p.variant == "density" and { 1e4, 1 } or { 1000, 1 }

local function block(k)
  local y = k == 1 and 0.35 or 0
  return { name = k == 1 and "upper" or "lower", shape = s.box { min = { -0.2, y, -0.2 }, max = { 0.2, y + 0.3, 0.2 } }, velocity = { 0, k == 1 and -1 or 0, 0 },
           material = { density = dense[k], elastic = { E = stiff[k], nu = 0.3 } } }
end

return s.scene {
  title  = "Contrast",
  solids = { block(1), block(2) },
  expect = { energy_gain = 0.02, momentum_drift = 1e-4, determinant_min = 0.005, speed_max = 20 },
}
