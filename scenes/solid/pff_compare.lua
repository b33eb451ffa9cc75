-- PFF compare: the same notched block, torn by this engine's damage and by its rival's phase field (PFF-MPM).
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 25; the rival is that of Wolper et al. 2019. The figure's numbers are not
-- given: the block and its jelly are those of sigma_eta.lua. The notch is cut without a gap: what lies inside it starts
-- broken.
--
--   variant      damage                            what to look for
--   isotropic    of this engine, without fibres    a crack straight on from the notch
--   pff          phase field                       the same crack
--   anisotropic  of this engine, along fibres      a crack along the fibres, which the phase field cannot have
--
-- The phase field has no critical stress but a toughness G. A bar of it, drawn slowly, carries E e/(1 + (e/e0)^2)^2 at a
-- strain e, with E e0^2/2 = G/(4 l0): at most 9/(16 sqrt 3) E e0. G is chosen so that this is the other's sigma_c. The phase
-- field is solved for on the grid at every step, which the explicit form of the other need not: compare particle_steps_per_s
-- of the two runs.
--
-- Try:  sunder runs diff RUN RUN     after a run of each
local s = require "sunder"

local p = s.params {
  particles     = 50000,
  duration      = { 3, unit = "time", doc = "216 frames" },
  fps           = 72,
  pull          = { 0.05, unit = "length/time", doc = "speed of each plate", min = 0 },
  break_stretch = { 0.20, doc = "where the block breaks, of either kind", min = 1e-3, max = 10 },
  angle         = { 45, unit = "degrees", doc = "of the fibres from the notch (anisotropic)", min = -90, max = 90 },
  notch         = { 0.12, unit = "length", doc = "depth of the notch in the left face", min = 0, max = 0.4 },
  variant       = s.choice { "isotropic", "pff", "anisotropic" },
}

local wide, high, deep = 0.4, 0.44, 0.2
local E, nu, residual = 200, 0.25, 0.01

-- sigma_c as break_stretch means it: the energy density of a body that is stretched by it in all directions.
local mu, lambda = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
local stretch = 1 + p.break_stretch
local growth = stretch ^ 3 - 1
local sigma_c = 1.5 * mu * (stretch ^ 2 - 1) - mu * growth + 0.5 * lambda * growth ^ 2

local dx = (8 * wide * high * deep / p.particles) ^ (1 / 3)
local l0 = dx / 2
local e0 = sigma_c / E * 16 * math.sqrt(3) / 9
local toughness = 4 * l0 * (1 - residual) * E * e0 ^ 2 / 2

local damage = { break_stretch = p.break_stretch, eta = 0.05, residual = residual, alpha = p.variant == "anisotropic" and -1 or 0 }
local tilt = math.rad(p.angle)

local function plate(side)
  return {
    name     = side < 0 and "bottom" or "top",
    shape    = s.box { center = { 0, side * 0.7, 0 }, size = { 4, 1, 4 } },
    velocity = { 0, side * p.pull, 0 },
  }
end

return s.scene {
  title = "PFF compare",
  dx    = dx,

  transfer       = "rpic",
  transfer_ratio = 0.01,

  solids = {
    {
      name     = "block",
      shape    = s.box { size = { wide, high, deep } },
      notches  = { s.box { min = { -1, -0.75 * dx, -1 }, max = { p.notch - wide / 2, 0.75 * dx, 1 } } },
      material = {
        density = 2,
        elastic = { E = E, nu = nu, lame = "paper" },
        fibres  = p.variant == "anisotropic" and { gamma = 10 } or false,
        damage  = p.variant ~= "pff" and damage or false,
        pff     = p.variant == "pff" and { toughness = toughness, length_scale = l0, residual = residual } or false,
      },
      fibres   = p.variant == "anisotropic" and s.fibres.direction { math.cos(tilt), math.sin(tilt), 0 } or nil,
    },
  },
  grips = { plate(-1), plate(1) },
}
