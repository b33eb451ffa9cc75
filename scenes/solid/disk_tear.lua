-- Disk tear: a disk with fibres up and down is torn apart from its upper edge.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 23. Its numbers are not given; ours are those of disk shoot, with an eta of
-- 0.02. The figure's (a) has inextensible fibres in place of elasticity. This scene has stiff fibres (gamma = 100) in
-- their place until there are inextensible ones.
--
--   variant    what to look for
--   fibres     a clean split along the fibres, from edge to edge                   (a, with stiff fibres)
--   isotropic  a tear square to the pull, whichever way the fibres would lie       (b)
--
-- The fibres are tilted a little from the vertical, so that one sees which of the two the tear follows.
local s = require "sunder"

local p = s.params {
  particles = 50000,
  duration  = { 4, unit = "time", doc = "96 frames" },
  fps       = 24,
  pull      = { 0.08, unit = "length/time", doc = "speed of each grip", min = 0 },
  tilt      = { 20, unit = "degrees", doc = "of the fibres from the vertical", min = -45, max = 45 },
  notch     = { 0.25, unit = "length", doc = "depth of the notch in the upper edge", min = 0, max = 0.4 },
  variant   = s.choice { "fibres", "isotropic" },
}

local radius, thick = 0.4, 0.06
local along = math.rad(p.tilt)
local disk = s.cylinder { axis = "z", radius = radius, length = thick }
local notch = s.box { min = { -0.012, radius - p.notch, -1 }, max = { 0.012, 1, 1 } }

local material = ({
  fibres    = s.recipe("tube", { elastic = { lame = "paper" }, fibres = { gamma = 100 },
                                 damage = { break_stretch = 0.07, eta = 0.02 } }),
  isotropic = s.recipe("tube", { elastic = { lame = "paper" }, fibres = false,
                                 damage = { break_stretch = 0.07, eta = 0.02, alpha = 0 } }),
})[p.variant]

-- The hands that tear hold the upper left and the upper right, down to the notch's tip.
local function hand(side)
  return {
    name     = side < 0 and "left" or "right",
    shape    = s.box { center = { side * 0.55, 0.55, 0 }, size = { 0.8, 0.8, 1 } },
    velocity = { side * p.pull, 0, 0 },
  }
end

return s.scene {
  title = "Disk tear",

  transfer       = "rpic",
  transfer_ratio = 0.01,

  solids = {
    {
      name     = "disk",
      shape    = disk - notch,
      material = material,
      fibres   = s.fibres.direction { -math.sin(along), math.cos(along), 0 },
    },
  },
  grips = { hand(-1), hand(1) },
}
