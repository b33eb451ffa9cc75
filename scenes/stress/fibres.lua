-- Fibres that snap, and the phase field, at their extremes.
--
--   snap_at_once    fibres break at the least strain, all in one step
--   snap_slow       the same, over a long time
--   weak_field      a phase field of next to no toughness
--   mobile_field    one that follows at once, of a mobility of 1e12
local s = require "sunder"
local p = s.params { duration = 0.3, fps = 40, dx = 0.1, variant = s.choice { "snap_at_once", "snap_slow", "weak_field", "mobile_field" } }
local v = p.variant
local snaps = v:find "snap"
local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.2, 9, 9 } }, velocity = { side * 0.5, 0, 0 } }
end

return s.scene {
  title  = "Fibres",
  solids = { { shape = s.box { size = { 1, 0.3, 0.3 }, center = { 0, 0, 0 } }, fibres = snaps and s.fibres.direction { 1, 0, 0 } or nil,
               material = { density = 1, elastic = { E = 1000, nu = 0.3 }, fibres = snaps and { gamma = 100 } or nil,
                            snapping = snaps and { snap_strain = v == "snap_slow" and 0.01 or 1e-6, snap_time = v == "snap_slow" and 1 or 0 } or nil,
                            pff = not snaps and { toughness = v == "weak_field" and 1e-9 or 0.5, mobility = v == "mobile_field" and 1e12 or 0, residual = 0.001 } or nil } } },
  grips  = { grip(-1), grip(1) },
  expect = { energy_gain = 0.02, speed_max = 40, determinant_min = 0.05, determinant_max = 20, broken_fraction = v == "weak_field" and { 0.1, 1 } or nil },
}
