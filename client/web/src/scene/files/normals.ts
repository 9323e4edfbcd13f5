import { Vector3 } from "three";

// Normals that go over edges smoothly: of every place the sum over its triangles, each as much as its area.
export function smoothNormals(positions: Float32Array, indices: Uint32Array): Float32Array {
  const place = placesOf(positions);
  const sums = new Float32Array(positions.length);
  const [a, b, c] = [new Vector3(), new Vector3(), new Vector3()];
  for (let i = 0; i + 2 < indices.length; i += 3) {
    const corners = [indices[i]!, indices[i + 1]!, indices[i + 2]!];
    [a, b, c].forEach((point, k) => point.fromArray(positions, 3 * corners[k]!));
    b.sub(a).cross(c.sub(a));
    for (const corner of corners) {
      const at = 3 * place[corner]!;
      sums[at]! += b.x;
      sums[at + 1]! += b.y;
      sums[at + 2]! += b.z;
    }
  }
  const normals = new Float32Array(positions.length);
  place.forEach((at, vertex) => a.fromArray(sums, 3 * at).normalize().toArray(normals, 3 * vertex));
  return normals;
}

// Of every vertex the first that is at the same place.
function placesOf(positions: Float32Array): Uint32Array {
  const first = new Map<string, number>();
  return Uint32Array.from({ length: positions.length / 3 }, (_, vertex) => {
    const key = positions.subarray(3 * vertex, 3 * vertex + 3).join(" ");
    const known = first.get(key) ?? vertex;
    first.set(key, known);
    return known;
  });
}
