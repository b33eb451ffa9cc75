-- Sigma and eta: a notched block of jelly with fibres at 45 degrees is drawn apart between two plates. One cell of the grid
-- of figures over break_stretch (that is, sigma_c) and eta; run it over a range of both.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 10 (and Fig. 18 over E and gamma), and the values of the authors' published
-- scene (a block .4 × .44 × .2 on a grid of 0.01, plates at ±0.05, 216 frames at 72 a second). The notch is ours.
--
--   break_stretch (sigma_c)  larger: breaks later, after more stretch
--   eta                      larger: the crack runs more slowly, and blunter
--   gamma                    larger: the crack keeps to the fibres more sharply
--
-- Try:  sunder run scenes/solid/sigma_eta.lua --set sigma_c=25 --set eta=0.02
--       sunder run scenes/solid/sigma_eta.lua --set sigma_c=50
local s = require "sunder"

local p = s.params {
  particles = 50000,
  duration  = { 3, unit = "time", doc = "216 frames" },
  fps       = 72,
  pull      = { 0.05, unit = "length/time", doc = "speed of each plate", min = 0 },
  angle     = { 45, unit = "degrees", doc = "of the fibres from the notch", min = -90, max = 90 },
  notch     = { 0.08, unit = "length", doc = "depth of the notch in the left face", min = 0, max = 0.4 },
}

local tilt = math.rad(p.angle)
local block = s.box { size = { 0.4, 0.44, 0.2 } }
local notch = s.box { min = { -1, -0.012, -1 }, max = { p.notch - 0.2, 0.012, 1 } }

-- The plates hold the top and the bottom 0.02 of the block: what lies between them is .4 high.
local function plate(side)
  return {
    name     = side < 0 and "bottom" or "top",
    shape    = s.box { center = { 0, side * 0.7, 0 }, size = { 4, 1, 4 } },
    velocity = { 0, side * p.pull, 0 },
  }
end

return s.scene {
  title = "Sigma and eta",

  transfer       = "rpic",
  transfer_ratio = 0.01,

  solids = {
    {
      name     = "block",
      shape    = block - notch,
      material = s.recipe "jello",
      fibres   = s.fibres.direction { math.cos(tilt), math.sin(tilt), 0 },
    },
  },
  grips = { plate(-1), plate(1) },
}
