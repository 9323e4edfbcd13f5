# Shapes for the demo scenes, printed as Wavefront OBJ; materials go to the MTL file named by -v mtl=FILE.
# Metres, +Y up, triangles and quads counter-clockwise from outside. POSIX awk, nothing else.

BEGIN {
  PI = atan2(0, -1)
  vertices = normals = 0
  if (mtl != "") {
    printf "" > mtl
    mtl_name = mtl
    sub(/.*\//, "", mtl_name)
    print "mtllib " mtl_name
  }
}

# material(name, r, g, b): diffuse albedo, linear.
function material(name, r, g, b) { printf "newmtl %s\nKd %.4f %.4f %.4f\n", name, r, g, b >> mtl }

# glow(name, r, g, b): a material that emits this radiance.
function glow(name, r, g, b) { printf "newmtl %s\nKd 0 0 0\nKe %.4f %.4f %.4f\n", name, r, g, b >> mtl }

# Faces wait until the end, so that each material is one object, with the name of the material.
function use(name) {
  if (!(name in faces)) order[++materials_used] = name
  in_use = name
}

function face(text) { faces[in_use] = faces[in_use] "f " text "\n" }

END {
  for (m = 1; m <= materials_used; m++) {
    if (order[m] != "") printf "o %s\nusemtl %s\n", order[m], order[m]
    printf "%s", faces[order[m]]
  }
}

function vertex(x, y, z) { printf "v %.5f %.5f %.5f\n", x, y, z; return ++vertices }

function normal(x, y, z,    length_) {
  length_ = sqrt(x * x + y * y + z * z)
  printf "vn %.5f %.5f %.5f\n", x / length_, y / length_, z / length_
  return ++normals
}

# quad(mat, a, b, c, d): flat; the normal from its first three corners.
function quad(mat, ax, ay, az, bx, by, bz, cx, cy, cz, dx, dy, dz,    ux, uy, uz, wx, wy, wz, n, v) {
  use(mat)
  ux = bx - ax; uy = by - ay; uz = bz - az
  wx = cx - ax; wy = cy - ay; wz = cz - az
  n = normal(uy * wz - uz * wy, uz * wx - ux * wz, ux * wy - uy * wx)
  v = vertex(ax, ay, az); vertex(bx, by, bz); vertex(cx, cy, cz); vertex(dx, dy, dz)
  face(v "//" n " " v + 1 "//" n " " v + 2 "//" n " " v + 3 "//" n)
}

# box(mat, low corner, high corner): faces outwards.
function box(mat, x0, y0, z0, x1, y1, z1) {
  quad(mat, x0, y0, z1, x1, y0, z1, x1, y1, z1, x0, y1, z1)
  quad(mat, x1, y0, z0, x0, y0, z0, x0, y1, z0, x1, y1, z0)
  quad(mat, x1, y0, z1, x1, y0, z0, x1, y1, z0, x1, y1, z1)
  quad(mat, x0, y0, z0, x0, y0, z1, x0, y1, z1, x0, y1, z0)
  quad(mat, x0, y1, z1, x1, y1, z1, x1, y1, z0, x0, y1, z0)
  quad(mat, x0, y0, z0, x1, y0, z0, x1, y0, z1, x0, y0, z1)
}

# cone(mat, centre x and z, radius and height at the bottom, radius and height at the top): the mantle, smooth around.
function cone(mat, cx, cz, r0, y0, r1, y1,    i, a, v, n, sides) {
  use(mat)
  sides = 24
  for (i = 0; i <= sides; i++) {
    a = 2 * PI * i / sides
    v = vertex(cx + r0 * cos(a), y0, cz - r0 * sin(a)); vertex(cx + r1 * cos(a), y1, cz - r1 * sin(a))
    n = normal((y1 - y0) * cos(a), r0 - r1, -(y1 - y0) * sin(a))
    if (i > 0) face(v - 2 "//" n - 1 " " v "//" n " " v + 1 "//" n " " v - 1 "//" n - 1)
  }
}

function disc(mat, cx, cy, cz, r) { cone(mat, cx, cz, r, cy, 0.001, cy + 0.0005) }

# sphere(mat, centre, radii, rings): smooth, about twice as many segments around.
function sphere(mat, cx, cy, cz, rx, ry, rz, rings,    i, j, theta, phi, columns, first, v, x, y, z) {
  use(mat)
  columns = 2 * rings
  first = vertices + 1
  for (j = 0; j <= rings; j++) {
    theta = PI * j / rings
    for (i = 0; i < columns; i++) {
      phi = 2 * PI * i / columns
      x = sin(theta) * cos(phi); y = -cos(theta); z = -sin(theta) * sin(phi)
      vertex(cx + rx * x, cy + ry * y, cz + rz * z)
      normal(x / rx, y / ry, z / rz)
    }
  }
  sphere_normals = normals - (vertices - first + 1) - first + 1
  for (j = 0; j < rings; j++)
    for (i = 0; i < columns; i++) {
      v = first + j * columns
      sphere_quad(v + i, v + (i + 1) % columns, columns, j == 0, j == rings - 1)
    }
}

# One patch of a sphere; a triangle at the poles, where two of its corners meet.
function sphere_quad(a, b, columns, south, north) {
  if (south) face(corner(a) " " corner(b + columns) " " corner(a + columns))
  else if (north) face(corner(a) " " corner(b) " " corner(b + columns))
  else face(corner(a) " " corner(b) " " corner(b + columns) " " corner(a + columns))
}

function corner(v) { return v "//" (v + sphere_normals) }
