# The demo room, seen through its open front: 5.2 x 2.7 x 4.4 m around the origin of the floor.

function materials(    i) {
  material("ceiling", 0.82, 0.80, 0.76)
  material("back_wall", 0.70, 0.62, 0.48)
  material("left_wall", 0.72, 0.34, 0.22)
  material("right_wall", 0.16, 0.38, 0.42)
  material("skirting", 0.80, 0.78, 0.74)
  material("plank_a", 0.40, 0.24, 0.12)
  material("plank_b", 0.46, 0.29, 0.15)
  material("plank_c", 0.35, 0.20, 0.10)
  material("rug", 0.52, 0.13, 0.12)
  material("rug_edge", 0.74, 0.62, 0.42)
  material("oak", 0.52, 0.35, 0.18)
  material("walnut", 0.22, 0.12, 0.07)
  material("linen", 0.36, 0.42, 0.50)
  material("cushion", 0.78, 0.52, 0.16)
  material("ceramic", 0.76, 0.74, 0.70)
  material("leaves", 0.12, 0.34, 0.10)
  material("book_red", 0.55, 0.10, 0.09)
  material("book_blue", 0.10, 0.18, 0.46)
  material("book_green", 0.12, 0.36, 0.20)
  material("book_sand", 0.68, 0.56, 0.36)
  material("paper", 0.78, 0.76, 0.70)
}

function shell(    i, x) {
  for (i = 0; i < 26; i++) {
    x = -2.6 + 0.2 * i
    quad("plank_" substr("abcacbbac", i % 9 + 1, 1), x, 0, 2.2, x + 0.2, 0, 2.2, x + 0.2, 0, -2.2, x, 0, -2.2)
  }
  quad("ceiling", -2.6, 2.7, -2.2, 2.6, 2.7, -2.2, 2.6, 2.7, 2.2, -2.6, 2.7, 2.2)
  quad("back_wall", -2.6, 0, -2.2, 2.6, 0, -2.2, 2.6, 2.7, -2.2, -2.6, 2.7, -2.2)
  quad("left_wall", -2.6, 0, 2.2, -2.6, 0, -2.2, -2.6, 2.7, -2.2, -2.6, 2.7, 2.2)
  quad("right_wall", 2.6, 0, -2.2, 2.6, 0, 2.2, 2.6, 2.7, 2.2, 2.6, 2.7, -2.2)
  box("skirting", -2.6, 0, -2.2, 2.6, 0.1, -2.17)
  box("skirting", -2.6, 0, -2.2, -2.57, 0.1, 2.2)
  box("skirting", 2.57, 0, -2.2, 2.6, 0.1, 2.2)
}

function rug() {
  box("rug_edge", -1.3, 0, -0.75, 1.3, 0.012, 0.95)
  box("rug", -1.15, 0, -0.6, 1.15, 0.016, 0.8)
}

function table(    i) {
  box("oak", -0.6, 0.38, -0.25, 0.6, 0.43, 0.4)
  for (i = 0; i < 4; i++)
    box("walnut", -0.55 + 1.04 * (i % 2), 0, -0.2 + 0.5 * int(i / 2), -0.49 + 1.04 * (i % 2), 0.38, -0.14 + 0.5 * int(i / 2))
  box("book_blue", -0.42, 0.43, 0.02, -0.12, 0.46, 0.24)
  box("book_sand", -0.40, 0.46, 0.04, -0.15, 0.485, 0.22)
  sphere("ceramic", 0.28, 0.52, 0.06, 0.11, 0.09, 0.11, 12)
}

function cabinet() {
  box("walnut", -1.0, 0.08, -2.17, 1.0, 0.12, -1.75)
  box("oak", -1.0, 0.12, -2.17, 1.0, 0.5, -1.77)
  box("walnut", -0.34, 0.15, -1.77, -0.33, 0.47, -1.765)
  box("walnut", 0.33, 0.15, -1.77, 0.34, 0.47, -1.765)
}

# Books from a fixed sequence: the room is the same in every run.
function shelf(    row, y, z, k, width, height) {
  box("walnut", -2.57, 0, -1.4, -2.22, 1.9, -1.36)
  box("walnut", -2.57, 0, 0.16, -2.22, 1.9, 0.2)
  k = 0
  for (row = 0; row < 5; row++) {
    y = 0.1 + 0.44 * row
    box("walnut", -2.57, y, -1.36, -2.22, y + 0.03, 0.16)
    if (row == 4) break
    for (z = -1.33; z < 0.02 - 0.3 * (row % 2); z += width) {
      k++
      width = 0.035 + 0.012 * (k * 7 % 5)
      height = 0.24 + 0.02 * (k * 5 % 7)
      box(book(k), -2.55, y + 0.03, z, -2.3 + 0.01 * (k % 3), y + 0.03 + height, z + width - 0.004)
    }
  }
}

function book(k) {
  k = k * 3 % 11
  return k < 3 ? "book_red" : k < 5 ? "book_blue" : k < 8 ? "book_green" : k < 10 ? "book_sand" : "paper"
}

function sofa() {
  box("linen", 1.62, 0.12, -1.1, 2.5, 0.42, 0.9)
  box("linen", 2.28, 0.42, -1.1, 2.5, 0.85, 0.9)
  box("linen", 1.62, 0.12, -1.3, 2.5, 0.62, -1.1)
  box("linen", 1.62, 0.12, 0.9, 2.5, 0.62, 1.1)
  box("cushion", 2.08, 0.42, -1.0, 2.26, 0.78, -0.6)
  box("cushion", 2.08, 0.42, 0.45, 2.26, 0.78, 0.85)
}

function plant() {
  cone("ceramic", 2.05, -1.75, 0.16, 0, 0.22, 0.4)
  disc("walnut", 2.05, 0.38, -1.75, 0.215)
  cone("walnut", 2.05, -1.75, 0.025, 0.38, 0.02, 0.9)
  sphere("leaves", 2.05, 1.15, -1.75, 0.3, 0.36, 0.3, 14)
  sphere("leaves", 1.88, 0.88, -1.66, 0.17, 0.2, 0.17, 12)
  sphere("leaves", 2.2, 0.92, -1.62, 0.15, 0.18, 0.15, 12)
}

# A column in the left corner and two pictures on the walls.
function decoration() {
  cone("ceramic", -1.95, -1.75, 0.16, 0, 0.16, 1.0)
  box("ceramic", -2.16, 1.0, -1.96, -1.74, 1.06, -1.54)
  sphere("cushion", -1.95, 1.22, -1.75, 0.16, 0.16, 0.16, 14)
  box("walnut", 2.57, 1.25, -0.7, 2.6, 2.0, 0.5)
  box("paper", 2.56, 1.31, -0.64, 2.59, 1.94, 0.44)
  box("book_blue", 2.55, 1.42, -0.5, 2.58, 1.6, 0.3)
  box("cushion", 2.55, 1.6, -0.2, 2.58, 1.82, 0.05)
}

BEGIN {
  materials()
  shell()
  rug()
  table()
  cabinet()
  shelf()
  sofa()
  plant()
  decoration()
}
