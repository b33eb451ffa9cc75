-- Brittle: damage at its extremes, in a bar that is pulled apart.
--
--   sudden           eta = 1e-9 with the implicit form: broken at once (the solid paper's Fig. 16)
--   sudden_explicit  the same with the explicit form, whose step would be of the size of eta: it says so
--   instant          eta = 0: rate-independent
--   weak             sigma_c next to nothing: all breaks at the first stress
--   strong           sigma_c far beyond every stress: nothing breaks
--   steep            zeta = 1e6: the driving force jumps to its bound
local s = require "sunder"
local p = s.params { duration = 0.3, fps = 40, dx = 0.1, variant = s.choice { "sudden", "sudden_explicit", "instant", "weak", "strong", "steep" } }
local v = p.variant
local damage = { sigma_c = v == "weak" and 1e-12 or v == "strong" and 1e18 or 20, eta = (v == "sudden" or v == "sudden_explicit") and 1e-9 or v == "instant" and 0 or 0.01,
                 form = (v == "sudden" or v == "instant" or v == "steep") and "implicit" or "explicit", zeta = v == "steep" and 1e6 or 1 }

local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.2, 9, 9 } }, velocity = { side * 0.5, 0, 0 } }
end

return s.scene {
  title  = "Brittle",
  solids = { { shape = s.box { size = { 1, 0.3, 0.3 }, center = { 0, 0, 0 } }, material = { density = 1, elastic = { E = 1000, nu = 0.3 }, damage = damage } } },
  grips  = { grip(-1), grip(1) },
  expect = v == "sudden_explicit" and { stop = "implicit" }
        or v == "strong" and { energy_gain = 0.02, damage_max = 0, speed_max = 5 }
        or { energy_gain = 0.02, broken_fraction = { 0.01, 1 }, speed_max = 30, determinant_min = 0.05, steps = 20000 },
}
