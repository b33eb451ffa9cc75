-- Extremes: a bar that is pulled apart, with parameters at the ends of their ranges. Whatever comes of it is finite; or the run says what it cannot do.
local s = require "sunder"
local all = {
  nu_least       = { damage = false, elastic = { nu = -0.999 } },
  soft           = { elastic = { E = 1e-9 } },
  light          = { density = 1e-4 },
  heavy          = { density = 1e9 },
  eta_most       = { damage = { eta = 1e6 } },
  zeta_least     = { damage = { zeta = 1e-6 } },
  zeta_explicit  = { damage = { zeta = 1e6, form = "explicit" } },
  residual_whole = { damage = { residual = 1 } },
  wide_cracks    = { damage = { length_scale = 10, form = "implicit" } },
  thin_cracks    = { damage = { length_scale = 1e-9, form = "implicit" } },
  loose          = { damage = { tolerance = 0.1, form = "implicit" } },
  exact          = { damage = { tolerance = 1e-14, form = "implicit" } },
  gamma_most     = { fibres = { gamma = 1e6 } },
  yield_most     = { damage = false, plastic = { yield_stress = 1e18 } },
  hardening_most = { damage = false, plastic = { yield_stress = 10, hardening = 1e18 } },
  toughness_least = { damage = false, pff = { toughness = 1e-18 } },
  toughness_most = { damage = false, pff = { toughness = 1e18 } },
  mobility_least = { damage = false, pff = { toughness = 0.1, mobility = 1e-12 } },
  pff_residual   = { damage = false, pff = { toughness = 0.1, residual = 0.999 } },
  relaxed        = { fibres = false, inextensible = { relaxation = 1e6 } },
  untight        = { fibres = false, inextensible = { tolerance = 0.5, relaxation = 1e-3 } },
  damping_most   = { mass_damping = 1e9 },
  heavy_gravity  = { gravity = { 0, -1e4, 0 } },
}
local names = {}
for name in pairs(all) do names[#names + 1] = name end
local p = s.params { duration = 0.1, fps = 40, dx = 0.1, variant = s.choice(names) }
local change = all[p.variant]

local matter = { density = change.density or 1, elastic = { E = 1000, nu = 0.3 }, fibres = { gamma = 10 }, damage = { break_stretch = 0.02, eta = 0.01, alpha = -0.5 } }
for name, values in pairs(change) do
  if matter[name] and type(values) == "table" then for key, value in pairs(values) do matter[name][key] = value end
  elseif name ~= "density" and name ~= "gravity" and name ~= "mass_damping" then matter[name] = values end
end
local pulled = not matter.inextensible
local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.2, 9, 9 } }, velocity = { side * 0.5, 0, 0 } }
end

return s.scene {
  title  = "Extremes", gravity = change.gravity, mass_damping = change.mass_damping,
  solids = { { shape = s.box { size = { 1, 0.3, 0.3 }, center = { 0, 0, 0 } }, fibres = s.fibres.direction { 1, 1, 0 }, material = matter,
               velocity = not pulled and function(x, y, z) return x, -y, 0 end or nil } },
  grips  = pulled and { grip(-1), grip(1) } or nil,
  -- Damping takes a node's impulse before its grip is asked what it did: at 1e9 the balance has no meaning.
  expect = { energy_gain = not change.mass_damping and 0.02 or nil, determinant_max = 100, speed_max = change.gravity and 2000 or 100 },
}
