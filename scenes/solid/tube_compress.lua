-- Tube compress: an upright tube that narrows towards the top, fibres running up its wall, crushed from above.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 3 and Table 1, and the values of the authors' published scene (400 000
-- particles, a crusher at speed 0.5 for 1.2 s, 140 frames at 24 a second). Their mesh is not published, so the tube's
-- measures are ours: a height of 1, a foot 0.7 wide, a wall five grid cells thick at the foot with 50 000 particles.
--
--   variant       damage          elasticity      what to look for
--   full          along fibres    with fibres     the wall splits into staves that buckle outwards   (b)
--   isotropic     everywhere      plain           it crumbles without a direction                    (c)
--   elastic_only  none            with fibres     it folds, and breaks only by numerical accident    (d)
--
-- Our choices beside the measures: the floor holds the foot (sticky), as the authors' colliders do; the crusher only
-- pushes, with some friction, so that the rim may spread below it. After 1.2 s it stays where it is.
local s = require "sunder"

local p = s.params {
  particles = 50000,
  duration  = { 140 / 24, unit = "time", doc = "140 frames" },
  fps       = 24,
  crush     = { 0.5, unit = "length/time", doc = "speed of the crusher", min = 0 },
  until_t   = { 1.2, unit = "time", doc = "when the crusher stops", min = 0 },
  friction  = { 0.4, doc = "between the crusher and the tube", min = 0, max = 10 },
  variant   = s.choice { "full", "isotropic", "elastic_only" },
}

local height, foot, bore, taper = 1, 0.35, 0.20, 0.7

-- lame = "paper": the authors use the plain Lamé coefficient.
local material = ({
  full         = s.recipe("cardboard", { elastic = { lame = "paper" } }),
  isotropic    = s.recipe("cardboard", { elastic = { lame = "paper" }, fibres = false, damage = { alpha = 0 } }),
  elastic_only = s.recipe("cardboard", { elastic = { lame = "paper" }, damage = false }),
})[p.variant]

return s.scene {
  title   = "Tube compress",
  gravity = { 0, -10, 0 },

  transfer       = "rpic",
  transfer_ratio = 0.01,
  cfl            = 0.7, -- what is damped so may take longer steps than a half: nearer to the paper's

  solids = {
    {
      name     = "tube",
      shape    = s.tube { axis = "y", length = height, outer = foot, inner = bore, taper = taper,
                          center = { 0, height / 2, 0 } },
      material = material,
      fibres   = s.fibres.direction { 0, 1, 0 },
    },
  },

  walls = { { name = "floor", point = { 0, 0, 0 }, normal = "y", contact = "sticky" } },

  colliders = {
    {
      name     = "crusher",
      shape    = s.box { min = { -1, height, -1 }, max = { 1, height + 0.3, 1 } },
      velocity = function(t) return 0, t < p.until_t and -p.crush or 0, 0 end,
      contact  = "separate",
      friction = p.friction,
    },
  },
}
