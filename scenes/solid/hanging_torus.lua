-- A heavy ring on four ropes (AnisoMPM, Fig. 21). Ropes of stiff elastic fibres give way under the heavier rings; inextensible ones hold
-- any. Ropes: E 10, nu .3; ring: E 100, density 0.75 to 30; gamma 100; no damage; 120 frames at 24 a second (Table 1 and the
-- authors' scene). The paper's size is particles = 110000; each step solves for the tension, and factors a matrix for it.
local s = require "sunder"
local p = s.params {
  particles = 20000, duration = 5, fps = 24,
  density = { 5, min = 0.01, max = 1e5, doc = "of the ring; the paper's run from 0.75 to 30" },
  variant = s.choice { "inextensible", "elastic" },
}
local rope = { density = 1, elastic = { E = 10, nu = 0.3 } }
if p.variant == "inextensible" then rope.inextensible = {} else rope.fibres = { gamma = 100 } end

local major, minor, thick, top = 0.30, 0.10, 0.045, 1.0
local ropes
for i = 0, 3 do
  local angle = i * math.pi / 2
  local one = s.cylinder { center = { major * math.cos(angle), top / 2 - minor / 2, major * math.sin(angle) }, axis = "y", radius = thick,
                           length = top + minor }
  ropes = ropes and ropes + one or one
end
return s.scene {
  title = "Hanging torus", gravity = { 0, -9.8, 0 }, transfer = "rpic",
  solids = {
    { name = "ropes", shape = ropes, material = rope, fibres = s.fibres.direction { 0, 1, 0 } },
    { name = "ring", shape = s.torus { axis = "y", major = major, minor = minor } - ropes,
      material = { density = p.density, elastic = { E = 100, nu = 0.3 } } },
  },
  grips = { { shape = s.box { min = { -1, top - 0.1, -1 }, max = { 1, top + 1, 1 } }, velocity = { 0, 0, 0 } } },
}
