-- Damage disk: a disk with a notch is torn; the scene to compare the ways in which damage is computed.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 15, which shows damage, its Laplacian and the opened crack of such a disk. Its
-- numbers are not given; ours are those of disk shoot, without fibres, and with an eta of 0.01, so that the crack outruns
-- the hands and stays narrow.
--
--   laplacian   quadratic  the second derivative of the quadratic kernel: cheap, constant within half a cell
--               cubic      of the cubic kernel, as the paper has it: wider, smoother
--   form        explicit   each particle from its own driving force; eta limits the time step
--               implicit   solved on the grid by conjugate gradients; any eta
--
-- What to look for: all four draw the same crack, straight down from the notch.
--
-- Try:  sunder run scenes/solid/damage_disk.lua --set laplacian=cubic
--       sunder run scenes/solid/damage_disk.lua --set form=implicit --set eta=0.001
local s = require "sunder"

local p = s.params {
  particles = 50000,
  duration  = { 3, unit = "time", doc = "72 frames" },
  fps       = 24,
  pull      = { 0.05, unit = "length/time", doc = "speed of each hand", min = 0 },
  notch     = { 0.25, unit = "length", doc = "depth of the notch at the top", min = 0, max = 0.4 },
  laplacian = s.choice { "quadratic", "cubic" },
  form      = s.choice { "explicit", "implicit" },
}

local radius, thick = 0.4, 0.06
local disk = s.cylinder { axis = "z", radius = radius, length = thick }
local notch = s.box { min = { -0.012, radius - p.notch, -1 }, max = { 0.012, 1, 1 } }

-- Hands at the upper left and the upper right open the notch, so that the stress gathers at its tip.
local function hand(side)
  return {
    name     = side < 0 and "left" or "right",
    shape    = s.box { center = { side * 0.55, 0.55, 0 }, size = { 0.8, 0.8, 1 } },
    velocity = { side * p.pull, 0, 0 },
  }
end

return s.scene {
  title     = "Damage disk",
  laplacian = p.laplacian,

  transfer       = "rpic",
  transfer_ratio = 0.01,

  solids = {
    {
      name     = "disk",
      shape    = disk - notch,
      material = s.recipe("tube", {
        elastic = { lame = "paper" },
        fibres  = false,
        damage  = { break_stretch = 0.07, eta = 0.01, alpha = 0, form = p.form, tolerance = 1e-4 },
      }),
    },
  },
  grips = { hand(-1), hand(1) },
}
