-- A thin square sheet, drawn far out at two sides (sheet paper, Fig. 3, bottom; Table 1).
local s = require "sunder"

local p = s.params {
  dx = 0.02, duration = 1.5, fps = 24,
  pull = { 0.5, unit = "length/time", doc = "speed of each grip" },
  variant = s.choice { "dry" },
}

return s.scene {
  title = "Stretched sheet",
  sheets = { { shape = s.rectangle { size = { 2, 2 } }, thickness = 0.02,
               material = { density = 5000, linear = { E = 2e4, nu = 0.3 } } } },
  grips = { { shape = s.box { min = { -1.1, -1.1, -1 }, max = { -0.94, 1.1, 1 } }, velocity = { -p.pull, 0, 0 } },
            { shape = s.box { min = { 0.94, -1.1, -1 }, max = { 1.1, 1.1, 1 } }, velocity = { p.pull, 0, 0 } } },
}
