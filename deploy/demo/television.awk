# A television on the cabinet: a dark frame, and a picture of glowing tiles, a sunset over hills.

function palette() {
  material("frame", 0.03, 0.03, 0.035)
  glow("night", 0.05, 0.16, 1.10)
  glow("dusk", 0.42, 0.20, 0.95)
  glow("rose", 1.15, 0.30, 0.36)
  glow("amber", 1.60, 0.70, 0.14)
  glow("sun", 2.60, 2.10, 1.00)
  glow("hill_far", 0.10, 0.20, 0.32)
  glow("hill_near", 0.05, 0.28, 0.09)
}

# The picture: colour of the tile in column i from the left and row j from the bottom.
function tile(i, j,    dx, dy) {
  if (j < 2.5 + 1.6 * sin(0.42 * i + 2.2)) return "hill_near"
  if (j < 4.6 + 1.8 * sin(0.27 * i + 0.4)) return "hill_far"
  dx = i - 21.5; dy = j - 8.5
  if (dx * dx + dy * dy < 14) return "sun"
  return j < 8 ? "amber" : j < 11 ? "rose" : j < 14 ? "dusk" : "night"
}

function picture(    i, j, colour, names, n, k, x, y, size) {
  n = split("night dusk rose amber sun hill_far hill_near", names, " ")
  size = 0.05
  for (k = 1; k <= n; k++)
    for (j = 0; j < 18; j++)
      for (i = 0; i < 32; i++)
        if (tile(i, j) == names[k]) {
          x = -0.8 + size * i; y = 0.7 + size * j
          quad(names[k], x, y, -1.9, x + size, y, -1.9, x + size, y + size, -1.9, x, y + size, -1.9)
        }
}

BEGIN {
  palette()
  box("frame", -0.84, 0.66, -1.98, 0.84, 1.64, -1.91)
  box("frame", -0.84, 0.66, -1.91, -0.8, 1.64, -1.89)
  box("frame", 0.8, 0.66, -1.91, 0.84, 1.64, -1.89)
  box("frame", -0.8, 0.66, -1.91, 0.8, 0.7, -1.89)
  box("frame", -0.8, 1.6, -1.91, 0.8, 1.64, -1.89)
  box("frame", -0.3, 0.5, -2.02, 0.3, 0.52, -1.85)
  box("frame", -0.05, 0.52, -1.97, 0.05, 0.66, -1.93)
  picture()
}
