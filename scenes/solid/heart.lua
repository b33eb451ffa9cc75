-- Heart: a heart is drawn apart by its two lobes until it breaks, and then let go.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 14 and Table 1, and the values of the authors' published scene (500 000
-- particles, flow-generated fibres, grips that move at ±0.2, a yield stress of 4, 72 frames at 24 a second). Their mesh is
-- not published: ours is two leaning capsules, of the volume that their grid and particles come to. That the grips let go
-- is ours too: what is left of the load then is what was plastic.
--
--   variant  what to look for
--   plastic  it is drawn out as it breaks, and stays drawn out                     (above)
--   elastic  it breaks as well, and both halves spring back                        (below)
--
-- Try:  sunder run scenes/solid/heart.lua --set yield_stress=2       softer still
local s = require "sunder"

local p = s.params {
  particles = 60000,
  duration  = { 3, unit = "time", doc = "72 frames" },
  fps       = 24,
  pull      = { 0.2, unit = "length/time", doc = "speed of each grip", min = 0 },
  until_t   = { 1.5, unit = "time", doc = "when the grips let go", min = 0.01 },
  variant   = s.choice { "plastic", "elastic" },
}

-- The heart faces along z; two capsules lean from the tip to the lobes.
local lobe, reach, rise = 0.13, 0.13, 0.33
local function half(side) return s.capsule { from = { 0, 0, 0 }, to = { side * reach, rise, 0 }, radius = lobe } end
local heart = half(-1) + half(1)

local function grip(side)
  return {
    name     = side < 0 and "left" or "right",
    shape    = s.box { center = { side * 0.6, 0.4, 0 }, size = { 0.86, 0.5, 1 } },
    velocity = { side * p.pull, 0, 0 },
    stop     = p.until_t,
  }
end

return s.scene {
  title = "Heart",

  transfer       = "rpic",
  transfer_ratio = 0.01,
  cfl            = 0.7, -- what is damped so may take longer steps than a half: nearer to the paper's

  solids = {
    {
      name     = "heart",
      shape    = heart,
      material = p.variant == "plastic" and s.recipe "heart" or s.recipe("heart", { plastic = false }),
      fibres   = s.fibres.flow { inflow  = s.box { min = { -1, -1, -1 }, max = { 1, -0.08, 1 } },
                                 outflow = s.box { min = { -1, 0.41, -1 }, max = { 1, 1, 1 } } },
    },
  },
  grips = { grip(-1), grip(1) },
}
