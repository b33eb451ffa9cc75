-- Lance: a soft toy hangs between four ropes and is pierced by a lance.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 9 and Table 1 (500 000 particles of toy, 150 000 of rope, a step of 1.25e-4,
-- 24 frames a second). Their armadillo is not at hand: ours has a torso, a head, two arms and two legs, of the volume that
-- their grid and particles come to. Ropes, lance and its speed are ours. The toy's fibres flow from hands and head to the
-- feet, the ropes' run along them.
--
--   variant       damage          ropes               what to look for
--   full          along fibres    stiff fibres        a slit along the fibres, narrower than the lance            (a)
--   isotropic     everywhere      stiff fibres        a wide wound, and the arms tear off across their fibres     (b)
--   inextensible  along fibres    inextensible        ropes whose fibres keep their length                        (c)
--
-- The ropes have no damage: stiff ones give way a little (0.3 % while the lance goes in), and pull the toy back. The fibres of (b) still hold
-- together what is broken, since no damage degrades them; without them (--set toy.fibres.gamma=0) its arms tear off and the toy falls
-- before it is pierced. Each step of (c) solves for the ropes' tension: several times the seconds of (a).
--
-- Try:  sunder run scenes/solid/lance.lua --set variant=isotropic
local s = require "sunder"

local p = s.params {
  particles = 80000,
  duration  = { 1.5, unit = "time", doc = "36 frames" },
  fps       = 24,
  speed     = { 0.5, unit = "length/time", doc = "of the lance", min = 0 },
  radius    = { 0.05, unit = "length", doc = "of the lance; one thinner than a grid cell is not felt", min = 0.001, max = 0.1 },
  friction  = { 0.1, doc = "between the lance and the toy", min = 0, max = 10 },
  variant   = s.choice { "full", "isotropic", "inextensible" },
}

local function limb(from, to, radius) return s.capsule { from = from, to = to, radius = radius } end
local function mirrored(x, make) return make(x) + make(-x) end

-- The toy faces the lance, which comes along z.
local torso = limb({ 0, -0.08, 0 }, { 0, 0.10, 0 }, 0.11)
local head = s.sphere { center = { 0, 0.25, 0 }, radius = 0.075 }
local arms = mirrored(1, function(side) return limb({ side * 0.08, 0.10, 0 }, { side * 0.22, 0.17, 0 }, 0.04) end)
local legs = mirrored(1, function(side) return limb({ side * 0.06, -0.12, 0 }, { side * 0.11, -0.30, 0 }, 0.05) end)
local toy = torso + head + arms + legs

local top, bottom = 0.50, -0.50
local function rope(from, to) return limb(from, to, 0.035) end
local ropes = mirrored(1, function(side)
  return rope({ side * 0.22, 0.17, 0 }, { side * 0.26, top, 0 }) + rope({ side * 0.11, -0.30, 0 }, { side * 0.16, bottom, 0 })
end)

local shaft = s.cylinder { axis = "z", radius = p.radius, length = 1, center = { 0, 0, -0.75 } }
local tip = s.tube { axis = "z", outer = p.radius, inner = 0, length = 0.1, taper = 0.2, center = { 0, 0, -0.2 } }

local rope_material = s.recipe("rope", p.variant == "inextensible" and { fibres = false, inextensible = {} } or {})
local damage = p.variant == "isotropic" and { alpha = 0 } or {}

return s.scene {
  title   = "Lance",
  gravity = { 0, -1, 0 },

  transfer       = "rpic",
  transfer_ratio = 0.01,
  cfl            = 0.7, -- what is damped so may take longer steps than a half: nearer to the paper's

  solids = {
    {
      name     = "toy",
      shape    = toy,
      material = s.recipe("toy", { damage = damage }),
      fibres   = s.fibres.flow { inflow  = s.box { min = { -1, 0.15, -1 }, max = { -0.19, 1, 1 } }
                                   + s.box { min = { 0.19, 0.15, -1 }, max = { 1, 1, 1 } }
                                   + s.box { min = { -1, 0.29, -1 }, max = { 1, 1, 1 } },
                                 outflow = s.box { min = { -1, -1, -1 }, max = { 1, -0.31, 1 } } },
    },
    {
      name     = "ropes",
      shape    = ropes - toy,
      material = rope_material,
      fibres   = s.fibres.direction { 0, 1, 0 },
    },
  },

  grips = {
    { name = "beam", shape = s.box { min = { -1, top - 0.02, -1 }, max = { 1, 1, 1 } } },
    { name = "ground", shape = s.box { min = { -1, -1, -1 }, max = { 1, bottom + 0.02, 1 } } },
  },

  colliders = {
    {
      name     = "lance",
      shape    = shaft + tip,
      velocity = { 0, 0, p.speed },
      contact  = "separate",
      friction = p.friction,
    },
  },
}
