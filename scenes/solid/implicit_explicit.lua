-- Implicit and explicit: the same notched block, with a crack that runs at once.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 16, and the values of the authors' published scene: the block of sigma_eta.lua
-- with a break_stretch of 45 %, an eta of 1e-9, and plates that stop at 0.8 s. Our plates move at 0.35: at the 0.05 of
-- sigma_eta.lua they have stretched the block by 20 % when they stop, and it does not break.
--
--   form      eta    what to look for
--   implicit  1e-9   the crack crosses the block within a few steps, along the fibres                       (a)
--   explicit  1e-3   the smallest eta that is still affordable: the same crack, later and wider             (b)
--
-- The explicit form cannot have 1e-9: each step would have to be below a thousand-millionth. With steps as long as the
-- waves allow, damage overshoots and floods the block from its first broken particle.
--
-- Try:  sunder run scenes/solid/implicit_explicit.lua --set form=explicit
--       sunder run scenes/solid/implicit_explicit.lua --set eta=0            the limit itself: as fast as it is driven
local s = require "sunder"

local p = s.params {
  particles = 80000,
  duration  = { 3, unit = "time", doc = "216 frames" },
  fps       = 72,
  pull      = { 0.35, unit = "length/time", doc = "speed of each plate", min = 0 },
  until_t   = { 0.8, unit = "time", doc = "when the plates stop", min = 0 },
  angle     = { 45, unit = "degrees", doc = "of the fibres from the notch", min = -90, max = 90 },
  notch     = { 0.10, unit = "length", doc = "depth of the notch in the left face", min = 0, max = 0.4 },
  form      = s.choice { "implicit", "explicit" },
}

local eta = ({ implicit = 1e-9, explicit = 1e-3 })[p.form]

local tilt = math.rad(p.angle)
local block = s.box { size = { 0.4, 0.44, 0.2 } }
local notch = s.box { min = { -1, -0.018, -1 }, max = { p.notch - 0.2, 0.018, 1 } }

local function plate(side)
  return {
    name     = side < 0 and "bottom" or "top",
    shape    = s.box { center = { 0, side * 0.7, 0 }, size = { 4, 1, 4 } },
    velocity = function(t) return 0, t < p.until_t and side * p.pull or 0, 0 end,
  }
end

return s.scene {
  title = "Implicit and explicit",

  transfer       = "rpic",
  transfer_ratio = 0.01,

  solids = {
    {
      name     = "block",
      shape    = block - notch,
      material = s.recipe("jello", { damage = { break_stretch = 0.45, eta = eta, form = p.form, tolerance = 1e-4 } }),
      fibres   = s.fibres.direction { math.cos(tilt), math.sin(tilt), 0 },
    },
  },
  grips = { plate(-1), plate(1) },
}
