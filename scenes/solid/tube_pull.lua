-- Tube pull: a tube with fibres at 45 degrees, pulled at both ends until it tears.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 2 and Table 1, and the values of the authors' published scene. What the
-- paper shows with it: only anisotropic damage together with anisotropic elasticity gives a tear that follows the
-- fibres cleanly.
--
--   variant       damage          elasticity      what to look for
--   full          along fibres    with fibres     a clean tear that winds along the fibres           (a)
--   isotropic     everywhere      plain           a tear straight across                             (b)
--   damage_only   along fibres    plain           a tear that the fibres guide weakly                (c)
--   elastic_only  none            with fibres     a tube that stretches and stretches, then falls
--                                                 apart wherever the particles are too far apart     (d)
--
-- Try:  sunder run scenes/solid/tube_pull.lua --set eta=0.1            more brittle
--       sunder run scenes/solid/tube_pull.lua --set break_stretch=0.1  tears earlier
--       sunder run scenes/solid/tube_pull.lua --set variant=isotropic
local s = require "sunder"

local p = s.params {
  particles = 50000,
  duration  = 7, -- 168 frames
  fps       = 24,
  pull      = { 0.1, unit = "length/time", doc = "speed of each grip", min = 0 },
  angle     = { 45, unit = "degrees", doc = "of the fibres from the tube's axis", min = -90, max = 90 },
  variant   = s.choice { "full", "isotropic", "damage_only", "elastic_only" },
}

-- lame = "paper": the authors use the plain Lamé coefficient, and their figures were made with it.
local material = ({
  full         = s.recipe("tube", { elastic = { lame = "paper" } }),
  isotropic    = s.recipe("tube", { elastic = { lame = "paper" }, fibres = false, damage = { alpha = 0 } }),
  damage_only  = s.recipe("tube", { elastic = { lame = "paper" }, fibres = false }),
  elastic_only = s.recipe("tube", { elastic = { lame = "paper" }, damage = false }),
})[p.variant]

local tilt = math.rad(p.angle)

-- A ball holds the tube near each end. What starts inside one is never damaged: the tear is to happen between them.
local function ball(side)
  return {
    name     = side < 0 and "left" or "right",
    shape    = s.sphere { center = { side * 0.6, 0, 0 }, radius = 0.3 },
    velocity = { side * p.pull, 0, 0 },
  }
end

return s.scene {
  title   = "Tube pull",
  gravity = { 0, -1, 0 },

  -- The authors' scenes are heavily damped, and look it: rigid rotation is carried, of the rest one per cent.
  transfer       = "rpic",
  transfer_ratio = 0.01,
  cfl            = 0.7, -- what is damped so may take longer steps than a half: nearer to the paper's

  solids = {
    {
      name     = "tube",
      shape    = s.tube { axis = "x", length = 2, outer = 0.30, inner = 0.12 },
      material = material,
      fibres   = s.fibres.direction { math.cos(tilt), math.sin(tilt), 0 },
    },
  },
  grips = { ball(-1), ball(1) },
}
