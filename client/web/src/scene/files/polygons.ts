import { ShapeUtils, Vector2, Vector3 } from "three";

// Appends the triangles of a polygon, whose corners are numbers of vertices. `pointOf` is where a corner is.
export function appendTriangles(corners: readonly number[], pointOf: (corner: number) => Vector3, out: number[]): void {
  if (corners.length < 3) return;
  if (corners.length === 3) {
    out.push(...corners);
    return;
  }
  const points = corners.map(pointOf);
  const normal = normalOf(points);
  if (isConvex(points, normal)) {
    for (let i = 2; i < corners.length; ++i) out.push(corners[0]!, corners[i - 1]!, corners[i]!);
    return;
  }
  for (const triangle of ShapeUtils.triangulateShape(flattened(points, normal), [])) out.push(...triangle.map((i) => corners[i]!));
}

// Of length twice the area (Newell's sum), so that bent polygons have one too.
function normalOf(points: readonly Vector3[]): Vector3 {
  const sum = new Vector3();
  points.forEach((a, i) => {
    const b = points[(i + 1) % points.length]!;
    sum.add(new Vector3((a.y - b.y) * (a.z + b.z), (a.z - b.z) * (a.x + b.x), (a.x - b.x) * (a.y + b.y)));
  });
  return sum;
}

function isConvex(points: readonly Vector3[], normal: Vector3): boolean {
  const edge = new Vector3();
  const next = new Vector3();
  return points.every((b, i) => {
    edge.subVectors(b, points[(i + points.length - 1) % points.length]!);
    next.subVectors(points[(i + 1) % points.length]!, b);
    return edge.cross(next).dot(normal) >= 0;
  });
}

// As seen along the normal, counter-clockwise.
function flattened(points: readonly Vector3[], normal: Vector3): Vector2[] {
  const n = normal.clone().normalize();
  const right = new Vector3(Math.abs(n.x) < 0.9 ? 1 : 0, Math.abs(n.x) < 0.9 ? 0 : 1, 0).cross(n).normalize();
  const up = n.clone().cross(right);
  return points.map((point) => new Vector2(point.dot(right), point.dot(up)));
}
