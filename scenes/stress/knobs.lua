-- Knobs: parameters turned by factors of a thousand while a bar tears.
local s = require "sunder"
local p = s.params { duration = 0.2, fps = 100, dx = 0.1 }
local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.2, 9, 9 } }, velocity = { side * 0.5, 0, 0 } }
end

return s.scene {
  title  = "Knobs", gravity = { 0, -1, 0 }, mass_damping = 1,
  solids = { { name = "bar", shape = s.box { size = { 1, 0.3, 0.3 }, center = { 0, 0, 0 } }, fibres = s.fibres.direction { 1, 1, 0 },
               material = { name = "bar", density = 1, elastic = { E = 1000, nu = 0.3 }, fibres = { gamma = 10 }, damage = { sigma_c = 20, eta = 0.1, alpha = -0.5 } } } },
  grips  = { grip(-1), grip(1) },
  expect = { speed_max = 300, determinant_max = 50, deformation_max = 50,
             turns = { { frame = 2, knob = "E", value = 1e6 }, { frame = 4, knob = "gamma", value = 1000 }, { frame = 5, knob = "E", value = 1 }, { frame = 6, knob = "nu", value = 0.499 },
                       { frame = 7, knob = "gamma", value = 0 }, { frame = 8, knob = "sigma_c", value = 1e-3 }, { frame = 9, knob = "E", value = 1e4 },
                       { frame = 10, knob = "eta", value = 1e-4 }, { frame = 11, knob = "gravity", value = "0,1000,0" }, { frame = 12, knob = "gravity", value = "0,-1,0" },
                       { frame = 13, knob = "mass_damping", value = 1000 }, { frame = 14, knob = "cfl", value = 1 } } },
}
