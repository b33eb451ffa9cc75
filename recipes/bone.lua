-- Compact bone: AnisoMPM's femur (Fig. 24; Table 1 gives E = 7e8 and sigma_c = 2.393e6, a break_stretch of 5 %; no stiff
-- fibres). A break_stretch of 5 % is an energy, and a stretch along one axis reaches it as a stress far earlier: at a third
-- of a per cent.
--
-- Waves run through it at a kilometre a second, a hundred thousand times as fast as the grips of the authors' scene, and
-- every step has to resolve them. A scene that is slow may as well take E a thousand times smaller: sigma_c follows from
-- break_stretch, so it breaks at the same stretch.
return {
  density = 800,
  elastic = { E = 7e8, nu = 0.25, lame = "paper" },
  damage  = { break_stretch = 0.05, eta = 0.1, alpha = -1, residual = 1e-4 },
}
