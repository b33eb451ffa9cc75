-- Sheets that are pulled: far, unequally, or apart.
--
--   rubber        to six times its length
--   square        a bond model whose bonds weaken without end (elastoplastic), to twice its length
--   thin          a thickness of 1e-9
--   nearly_half   nu = 0.9 in the plane, pulled
--   auxetic       nu = -0.5
--   no_toughness  G next to 0: all bonds break at the first stretch
--   unbreakable   G = 1e18
--   grain         a thousand times as stiff along the grain as across
--   scattered     R = 3 spacings on a scattered lattice
local s = require "sunder"
local p = s.params { duration = 0.5, fps = 40, dx = 0.1,
  variant = s.choice { "rubber", "square", "thin", "nearly_half", "auxetic", "no_toughness", "unbreakable", "grain", "scattered" } }
local v = p.variant
local pull = v == "rubber" and 5 or v == "square" and 1 or 0.1
local matter = { density = 1000, damping = { rate = 1 } }
if v == "rubber" then matter.rubber = { E = 1e6 }
elseif v == "square" then matter.elastoplastic, matter.fracture = { E = 1e6, eta0 = 0.001, beta = 0.1 }, { stretch = 10 }
else matter.linear = { E = 1e6, nu = v == "nearly_half" and 0.9 or v == "auxetic" and -0.5 or nil } end
if v == "no_toughness" then matter.fracture = { G = 1e-12 } elseif v == "unbreakable" then matter.fracture = { G = 1e18 } end
if v == "grain" then matter.grain = { stiffness = 1000, toughness = 1000 } matter.fracture = { G = 10 } end

local function grip(side)
  return { shape = s.box { center = { 0.5 * side, 0, 0 }, size = { 0.21, 9, 9 } }, velocity = { side * pull, 0, 0 } }
end

return s.scene {
  title  = "Sheet pull",
  sheets = { { shape = s.rectangle { size = { 1, 0.6 } }, thickness = v == "thin" and 1e-9 or 0.01, spacing = 0.05, material = matter,
               lattice = v == "scattered" and "scattered" or "square", radius = v == "scattered" and 3 or nil, grain = v == "grain" and s.fibres.direction { 1, 1, 0 } or nil } },
  grips  = { grip(-1), grip(1) },
  expect = { energy_gain = 0.02, speed_max = 60, spread = 8, broken_fraction = v == "no_toughness" and { 0.01, 1 } or v == "unbreakable" and 0 or nil,
             bond_stretch_max = v == "rubber" and { 4, 12 } or nil },
}
