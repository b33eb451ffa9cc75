-- Domain: where material may not be.
--
--   leaves    a block flies out of the domain: the run stops and says so
--   outside   a block that starts outside of it
--   edge      a block that rests at the domain's very edge stays
local s = require "sunder"
local p = s.params { duration = 1, fps = 10, dx = 0.1, variant = s.choice { "leaves", "outside", "edge" } }
local v = p.variant
local x = v == "outside" and 5 or v == "edge" and 0.8 or 0

return s.scene {
  title  = "Domain", domain = { min = { -1, -1, -1 }, max = { 1, 1, 1 } },
  solids = { { shape = s.box { min = { x - 0.2, -0.2, -0.2 }, max = { x + 0.2, 0.2, 0.2 } }, velocity = { v == "leaves" and 5 or 0, 0, 0 },
               material = { density = 1, elastic = { E = 1000, nu = 0.3 } } } },
  expect = v == "edge" and { energy_drift = 1e-6, speed_max = 1e-3, high_x = 1 } or { stop = "domain" },
}
