-- expect: 12_unknown_recipe.lua:4 key=recipe nearest=tube
local s = require "sunder"
return s.scene {
  solids = { { shape = s.sphere { radius = 1 }, material = s.recipe "tubbe" } },
}
