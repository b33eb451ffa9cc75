-- Sheet extremes: a sheet that is pulled and warmed, with parameters at the ends of their ranges. Whatever comes of it is finite; or the run says what it cannot do.
local s = require "sunder"
local all = {
  still_air     = { drag = { coefficient = 1e12 } },
  storm         = { drag = { coefficient = 1e3, wind = { 0, 0, 1e3 } } },
  damping_most  = { damping = { rate = 1e9 } },
  grain_least   = { grain = { stiffness = 0.001, toughness = 0.001 } },
  stiff_plate   = { bending = { stiffness = 1e6 } },
  hard_contact  = { self_contact = { distance = 1, stiffness = 1000 } },
  shrinks       = { swelling = -100 },
  swells        = { swelling = 100 },
  softens       = { softening = { stiffness = 1e6, toughness = 1e6, floor = 1e-6 } },
  decays        = { diffusion = { decay = 1e9 } },
  frozen        = { diffusion = { k = 0 } },
  total         = { swelling = 1, fracture = { criterion = "total" } },
  reach         = { radius = 6 },
  paper         = { linear = { calibration = "paper", weight = "paper", poisson = "bond" } },
  nu_least      = { linear = { nu = -0.5, E = 1e5 } },
  levels_most   = { multirate = { levels = 5, cracking = 2, heated = 2 } },
}
local names = {}
for name in pairs(all) do names[#names + 1] = name end
local p = s.params { duration = 0.1, fps = 40, dx = 0.1, variant = s.choice(names) }
local change = all[p.variant]

local matter = { density = 1000, linear = { E = 1e5 }, fracture = { G = 10 }, diffusion = { k = 1000, C = 1 } }
for name, values in pairs(change) do
  if matter[name] and type(values) == "table" then for key, value in pairs(values) do matter[name][key] = value end
  elseif name ~= "radius" then matter[name] = values end
end
local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.21, 9, 9 } }, velocity = { side * 0.5, 0, 0 } }
end

return s.scene {
  title  = "Sheet extremes",
  sheets = { { shape = s.rectangle { size = { 1, 0.6 } }, thickness = 0.01, spacing = 0.05, radius = change.radius, ripple = 0.01, material = matter,
               grain = change.grain and s.fibres.direction { 1, 1, 0 } or nil, sources = { { shape = s.sphere { radius = 0.2 }, value = 1 } } } },
  grips  = { grip(-1), grip(1) },
  expect = p.variant == "swells" and { stop = "runs away" } or { speed_max = 1e4, diffused_min = -1e-4, diffused_max = 1.0001 },
}
