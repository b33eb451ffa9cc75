-- Sheets that are pressed together, in their plane and on themselves.
--
--   collapse   bonds pressed to nothing: the grips meet
--   crumple    two edges brought together: it folds, with bending and contact with itself
--   fold       laid double and pressed by a plate
--   rubber     a rubbery sheet pressed to nothing, whose force grows without end
local s = require "sunder"
local p = s.params { duration = 0.5, fps = 40, dx = 0.1, variant = s.choice { "collapse", "crumple", "fold", "rubber" } }
local v = p.variant
local matter = { density = 1000, damping = { rate = 1 }, [v == "rubber" and "rubber" or "linear"] = { E = 1e4 } }
if v == "crumple" or v == "fold" then
  matter.bending = { stiffness = 1e-4 }
  matter.self_contact = { distance = 0.8, stiffness = 1 }
end
local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.21, 9, 9 } }, velocity = { -side * 0.85, 0, 0 } }
end

return s.scene {
  title     = "Sheet crumple",
  sheets    = { { shape = s.rectangle { size = { 1, 0.6 } }, thickness = 0.01, spacing = 0.05, ripple = (v == "crumple" or v == "fold") and 0.05 or 0, material = matter } },
  grips     = v ~= "fold" and { grip(-1), grip(1) } or { grip(-1) },
  colliders = v == "fold" and { { shape = s.box { min = { 0, -2, 0.1 }, max = { 2, 2, 0.3 } }, velocity = { 0, 0, -1 }, contact = "slip" },
                                { shape = s.box { min = { 0, -2, -0.3 }, max = { 2, 2, -0.1 } }, velocity = { 0, 0, 0 }, contact = "slip" } } or nil,
  expect    = { energy_gain = 0.02, speed_max = 60, spread = 3 },
}
