-- Sheets in pieces: bonds that are missing.
--
--   dust       every bond is cut from the start: particles fall alone
--   holes      a sheet full of holes, some of its particles with one bond or none
--   single     a sheet of one particle
--   strip      a row of particles
--   both       two engines at once, with grips that hold both
local s = require "sunder"
local p = s.params { duration = 0.5, fps = 40, dx = 0.1, variant = s.choice { "dust", "holes", "single", "strip", "both" } }
local v = p.variant
local matter = { density = 1000, linear = { E = 1e5 }, fracture = { G = 100 }, drag = { coefficient = 1 } }
local shape = v == "single" and s.rectangle { size = { 0.04, 0.04 }, center = { 0.5, 0.3, 0 } } or v == "strip" and s.rectangle { size = { 1, 0.04 } } or s.rectangle { size = { 1, 0.6 } }
if v == "holes" then
  for i = 0, 24 do shape = shape - s.sphere { center = { -0.5 + 0.17 * (i % 7) + 0.03 * (i // 7), -0.3 + 0.16 * (i // 7), 0 }, radius = 0.065 } end
end

return s.scene {
  title  = "Sheet pieces", gravity = { 0, 0, -10 },
  sheets = { { shape = shape, thickness = 0.01, spacing = 0.05, material = matter, notches = v == "dust" and { { shape = s.sphere { radius = 9 } } } or nil } },
  solids = v == "both" and { { shape = s.box { min = { -0.5, -0.1, -0.4 }, max = { 0.5, 0.1, -0.2 } }, material = { density = 1, elastic = { E = 1000, nu = 0.3 } } } } or nil,
  grips  = v == "both" and { { shape = s.box { center = { -0.5, 0, 0 }, size = { 0.21, 9, 9 } } } } or nil,
  walls  = { { point = { 0, 0, -0.5 }, normal = "z", contact = "separate", friction = 0.3 } },
  expect = { energy_gain = 0.02, speed_max = 10, low_z = v == "both" and -0.6 or -0.51, spread = { 0, 4 }, broken_fraction = v == "dust" and { 0.99, 1 } or nil },
}
