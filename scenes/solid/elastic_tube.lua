-- Elastic tube: a tube is stretched, and its cross section tells how its fibres lie. Nothing breaks.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 17. The tube, its grips and its matrix are those of tube_pull.lua.
--
--   variant      gamma  gamma2  what to look for in the middle's cross section
--   isotropic    -      -       equally narrow both ways                                  (a)
--   transverse   15     0       wider across (z), where the fibres run                    (b)
--   orthotropic  15     3       as wide across, and less flat                             (c)
--
-- Try:  sunder run scenes/solid/elastic_tube.lua --set gamma=100
local s = require "sunder"

local p = s.params {
  particles = 50000,
  duration  = { 3, unit = "time", doc = "72 frames" },
  fps       = 24,
  pull      = { 0.2, unit = "length/time", doc = "speed of each grip", min = 0 },
  variant   = s.choice { "orthotropic", "transverse", "isotropic" },
}

local fibres = ({
  orthotropic = { gamma = 15, gamma2 = 3 },
  transverse  = { gamma = 15 },
  isotropic   = false,
})[p.variant]

local function ball(side)
  return {
    name     = side < 0 and "left" or "right",
    shape    = s.sphere { center = { side * 0.9, 0, 0 }, radius = 0.3 },
    velocity = { side * p.pull, 0, 0 },
  }
end

return s.scene {
  title = "Elastic tube",

  transfer       = "rpic",
  transfer_ratio = 0.01,

  solids = {
    {
      name     = "tube",
      shape    = s.tube { axis = "x", length = 2, outer = 0.30, inner = 0.12 },
      material = s.recipe("tube", { elastic = { lame = "paper" }, fibres = fibres, damage = false }),
      fibres   = fibres and s.fibres.direction({ 0, 0, 1 }, { 0, 1, 0 }) or nil,
    },
  },
  grips = { ball(-1), ball(1) },
}
