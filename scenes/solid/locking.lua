-- A prism of jello held at one end (AnisoMPM, Fig. 22). Its fibres are parallel, or each turned a little at random. Stiff elastic
-- fibres lock when they are turned: the prism hangs less. Inextensible ones hang as the parallel ones do.
local s = require "sunder"
local p = s.params {
  particles = 8000, duration = 4, fps = 24, -- until little of the swing is left
  spread = { 2, min = 0, max = 20, unit = "degrees", doc = "how far perturbed fibres are turned at most" },
  gamma = { 1000, min = 1, max = 1e6, doc = "stiffness of the elastic fibres" },
  variant = s.choice { "inextensible", "inextensible_perturbed", "elastic", "elastic_perturbed" },
}
local jello = s.recipe("jello", { plastic = false, damage = false, density = 1, elastic = { E = 100, nu = 0.3 } })
if p.variant:find "inextensible" then jello.inextensible, jello.fibres = {}, nil else jello.fibres = { gamma = p.gamma } end
return s.scene {
  title = "Locking", gravity = { 0, -9.8, 0 }, transfer = "rpic",
  solids = { { name = "prism", shape = s.box { min = { -0.5, -0.2, -0.2 }, max = { 0.5, 0.2, 0.2 } }, material = jello,
               fibres = s.fibres.random { direction = "x", spread = p.variant:find "perturbed" and p.spread or 0 } } },
  grips = { { shape = s.box { min = { -2, -1, -1 }, max = { -0.4, 1, 1 } }, velocity = { 0, 0, 0 } } },
}
