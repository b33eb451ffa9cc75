-- Cfl: the longest steps that are allowed, on a block that rings, in each transfer.
--
--   apic, cubic       cfl = 1
--   rpic, pic, flip   cfl = 0.8; flip with ratio 1, which damps nothing
--   rpic_1, flip_1    cfl = 1: too long for transfers that carry no whole affine velocity
local s = require "sunder"
local p = s.params { duration = 1, fps = 20, dx = 0.1, variant = s.choice { "apic", "cubic", "rpic", "pic", "flip", "rpic_1", "flip_1" } }
local transfer = ({ cubic = "apic", rpic_1 = "rpic", flip_1 = "flip" })[p.variant] or p.variant
local too_long = p.variant:find "_1" and "cfl above 0.8 is too long for pic, rpic and flip, and warned about: docs/stress.md" or nil

return s.scene {
  title  = "Cfl", transfer = transfer, transfer_ratio = transfer == "flip" and 1 or 0, cfl = (too_long or transfer == "apic") and 1 or 0.8, kernel = p.variant == "cubic" and "cubic" or "quadratic",
  solids = { { shape = s.box { size = { 0.6, 0.3, 0.3 }, center = { 0, 0, 0 } }, velocity = function(x, y, z) return 5 * x, 0, 0 end,
               material = { density = 1, elastic = { E = 1000, nu = 0.3 } } } },
  expect = { energy_gain = 0.05, momentum_drift = 1e-4, determinant_min = 0.5, determinant_max = 2, speed_max = 6, spread = 1.5, known_limit = too_long },
}
