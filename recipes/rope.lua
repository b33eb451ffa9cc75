-- Rope: what AnisoMPM's armadillo hangs from (Fig. 9; Table 1). Next to nothing across, a thousand times as stiff along:
-- it gives way to the side and hardly stretches. It does not break.
return {
  density = 2,
  elastic = { E = 10, nu = 0.3, lame = "paper" },
  fibres  = { gamma = 1000 },
}
