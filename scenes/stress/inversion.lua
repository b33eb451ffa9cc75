-- Inversion: bodies of tetrahedra that start in a state that no body is ever in, and must find back.
--
--   random             every vertex is anywhere, on its own
--   collapsed          all vertices in one point but for seeds of 1e-6; two families of fibres make that state unstable
--   flat               squeezed into a plane exactly: det F = 0 everywhere
--   corotated          random, with the corotated model
--   collapsed_matrix   collapsed, without fibres: P(0) = 0 and the energy's second derivative there is mu: no way out
local s = require "sunder"
local p = s.params { particles = 150, duration = 4, fps = 12, variant = s.choice { "random", "collapsed", "flat", "corotated", "collapsed_matrix" } }

local function chance(x, y, z, k)
  local v = math.sin(127.1 * x + 311.7 * y + 74.7 * z + 53.9 * k) * 43758.5453
  return v - math.floor(v)
end
local function anywhere(size)
  return function(x, y, z) return size * (chance(x, y, z, 1) - 0.5), size * (chance(x, y, z, 2) - 0.5), size * (chance(x, y, z, 3) - 0.5) end
end
local v = p.variant
local start = v == "flat" and function(x, y, z) return x, y, 0 end or anywhere((v == "random" or v == "corotated") and 0.6 or 2e-6)
local fibres = (v == "random" or v == "collapsed") and { gamma = 10, gamma2 = 10 } or nil

return s.scene {
  title        = "Inversion",
  mass_damping = 6,
  solids = { { shape    = s.box { size = { 1, 0.6, 0.6 }, center = { 0, 0, 0 } }, discretisation = "tetrahedra", start = start,
               fibres   = fibres and s.fibres.direction({ 0, 1, 0 }, { 1, 0, 0 }) or nil,
               material = { density = 1, [v == "corotated" and "corotated" or "elastic"] = { E = 100, nu = 0.3 }, fibres = fibres } } },
  expect = v == "flat" and { energy_gain = 0.01, stored_left = 1e-3, determinant_end = 0.9 }
        or v == "collapsed_matrix" and { energy_gain = 0.01, determinant_end = 0.9, known_limit = "no force acts where F = 0: METHOD.md section 1, the barrier at gamma = 0" }
        or { energy_gain = 0.01, stored_left = 1e-3, determinant_end = 0.9 },
}
