-- Bone: a thighbone with fibres along its shaft is held at both heads and twisted, pulled or bent until it breaks.
--
-- Source: AnisoMPM (Wolper et al. 2020), Fig. 24 and Table 1, and the values of the authors' published scenes (200 000
-- particles, grips that turn by 40 degrees a second or move at 0.02 to 0.04, 144 frames at 48 a second). Their mesh is not
-- published: ours is a shaft that widens towards two knuckles below and a neck and a ball above, sturdier than a real one, so
-- that the shaft is eight grid cells across where there are 40 000 particles.
--
--   variant  load                                       what to look for
--   twist    the heads turn against one another,        a spiral: the break winds around the shaft at 45 degrees,
--            and draw apart a little                    and closes along it                                          (a)
--   pull     both heads are drawn apart                 a break straight across                                      (b)
--   bend     both heads turn sideways, the same way     an oblique break: between them the shaft is sheared          (c)
--
-- Our choices:
-- * Stiffness. Bone's own E of 7e8 makes waves of a kilometre a second, and a step of a few millionths: days of computing, for
--   grips that move at a snail's pace. E is a thousand times smaller here, and so is sigma_c, which follows from
--   break_stretch; waves are still three hundred times faster than the grips, and it breaks at the same stretch.
-- * Time. With Table 1's eta of 0.1 the grips outrun the damage: the shaft is ten times over its limit everywhere before
--   it has broken anywhere, and then it crumbles. A smaller eta is the same as grips that move more slowly.
-- * A flaw: a small hole in the shaft's front, broken from the start, as a screw or a vessel leaves. A crack starts there and
--   finds its own way; without it a twisted shaft has no weakest place, and is sheared off across.
--
-- Try:  sunder run scenes/solid/bone.lua --set E=7e8 --set eta=0.1     the paper's own, if you have a week
--       sunder run scenes/solid/bone.lua --set alpha=0 --set variant=pull
local s = require "sunder"

local p = s.params {
  particles = 40000,
  duration  = { 3, unit = "time", doc = "144 frames" },
  fps       = 48,
  turn      = { 40, unit = "degrees/time", doc = "how fast each head turns (twist, bend)", min = 0 },
  pull      = { 0.02, unit = "length/time", doc = "how fast each head is drawn away (pull; a tenth of it in twist)", min = 0 },
  flaw      = { 0.008, unit = "length", doc = "radius of the hole in the shaft, 0.02 deep; 0: none", min = 0, max = 0.02 },
  variant   = s.choice { "twist", "pull", "bend" },
}

-- The femur stands along y. A shaft that widens towards its ends, two knuckles at the knee, neck and ball at the hip.
local slim, wide = 0.038, 0.055
local function column(radius, from, to, taper)
  return s.tube { axis = from < to and "y" or "-y", outer = radius, inner = 0, length = math.abs(to - from), taper = taper,
                  center = { 0, (from + to) / 2, 0 } }
end
local femur = column(slim, -0.065, 0.065)
  + column(slim, 0.06, 0.13, wide / slim) + column(slim, -0.06, -0.13, wide / slim)
  + column(wide, 0.125, 0.175) + column(wide, -0.125, -0.175)
  + s.capsule { from = { 0.024, -0.19, 0.008 }, to = { 0.024, -0.19, -0.008 }, radius = 0.044 }
  + s.capsule { from = { -0.024, -0.19, 0.008 }, to = { -0.024, -0.19, -0.008 }, radius = 0.044 }
  + s.capsule { from = { 0, 0.17, 0 }, to = { 0.055, 0.205, 0 }, radius = 0.030 }
  + s.sphere { center = { 0.06, 0.215, 0 }, radius = 0.036 }
  + s.sphere { center = { -0.012, 0.185, 0 }, radius = 0.044 }

local hole = p.flaw > 0 and s.cylinder { axis = "z", radius = p.flaw, length = 0.04, center = { 0, 0, slim } }

-- The twisted bone breaks at twice the stretch, in the authors' scenes too.
local break_stretch = p.variant == "twist" and 0.10 or 0.05
local rate = math.rad(p.turn)

local function grip(side)
  return {
    name     = side < 0 and "knee" or "hip",
    shape    = s.box { center = { 0, side * 0.22, 0 }, size = { 0.2, 0.18, 0.3 } },
    velocity = ({ pull = { 0, side * p.pull, 0 }, twist = { 0, side * p.pull / 10, 0 } })[p.variant],
    spin     = ({ twist = { 0, side * rate, 0 }, bend = { 0, 0, rate } })[p.variant],
    pivot    = { 0, side * 0.13, 0 },
  }
end

return s.scene {
  title = "Bone",

  transfer       = "rpic",
  transfer_ratio = 0.01,

  solids = {
    {
      name     = "femur",
      shape    = femur,
      notches  = hole and { hole } or nil,
      material = s.recipe("bone", { elastic = { E = 7e5 }, damage = { break_stretch = break_stretch, eta = 0.003 } }),
      fibres   = s.fibres.direction { 0, 1, 0 },
    },
  },
  grips = { grip(-1), grip(1) },
}
