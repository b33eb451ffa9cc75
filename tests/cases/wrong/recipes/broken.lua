return {
  density = 1,
  elastic = { E = "hard" },
}
