-- Pork belly: a block with its base held is pulled at one upper corner, up and inwards, by a small ball.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 4 and Table 1, and the values of the authors' published scene (500 000
-- particles, a sticky base, a ball of radius 0.05 that moves with (0.05, 0.05, 0.05), 384 frames at 24 a second). The block
-- has the volume that their grid and particles come to.
--
--   variant      fibres                    what to look for
--   orthotropic  along the layers, both    the top layer peels off as a whole            (left)
--   transverse   along x alone             a strip of the top layer peels off            (middle)
--   isotropic    none                      a small piece is pulled out at the corner     (right)
--
-- The three kinds are three structural tensors, and two numbers: alpha and alpha2 (-1 or 0).
--
-- Try:  sunder run scenes/solid/pork_belly.lua --set variant=transverse --set break_stretch=0.3
local s = require "sunder"

local p = s.params {
  particles = 50000,
  duration  = { 16, unit = "time", doc = "384 frames" },
  fps       = 24,
  speed     = { 0.05, unit = "length/time", doc = "of the ball, along each axis", min = 0 },
  variant   = s.choice { "orthotropic", "transverse", "isotropic" },
}

local material = ({
  orthotropic = s.recipe "pork",
  transverse  = s.recipe("pork", { fibres = { gamma2 = 0 }, damage = { alpha2 = 0 } }),
  isotropic   = s.recipe("pork", { fibres = false, damage = { alpha = 0, alpha2 = 0 } }),
})[p.variant]

local half, height = 0.2, 0.15

return s.scene {
  title = "Pork belly",

  transfer       = "rpic",
  transfer_ratio = 0.01,
  cfl            = 0.7, -- what is damped so may take longer steps than a half: nearer to the paper's

  solids = {
    {
      name     = "belly",
      shape    = s.box { min = { -half, 0, -half }, max = { half, height, half } },
      material = material,
      fibres   = s.fibres.direction({ 1, 0, 0 }, { 0, 0, 1 }), -- both lie in the layers
    },
  },

  -- The ball holds a corner of the top and lifts it inwards, over the block.
  grips = {
    {
      name     = "ball",
      shape    = s.sphere { center = { -half, height, -half }, radius = 0.05 },
      velocity = { p.speed, p.speed, p.speed },
    },
    { name = "base", shape = s.box { min = { -1, -1, -1 }, max = { 1, 0.02, 1 } } },
  },
}
