import { Matrix3, Matrix4, Quaternion, Vector3 } from "three";
import type { Box } from "../../../gen/lpv/v1/geometry_pb.ts";
import type { Placement } from "../placement.ts";
import { NO_PLACEMENT, type Part, type Triangles } from "./parts.ts";

const SHEAR = 1e-4; // cosine between axes of a matrix that came through floats
const SHORTEST = 1e-9;

const plain = ({ x, y, z }: Vector3): { x: number; y: number; z: number } => ({ x, y, z });

// Undefined for a matrix that shears or is flat: no placement says that.
export function placementFrom(matrix: Matrix4): Placement | undefined {
  const axis = (column: number): Vector3 => new Vector3().setFromMatrixColumn(matrix, column);
  const axes = [axis(0), axis(1), axis(2)] as const;
  const scale = new Vector3(...axes.map((one) => one.length()));
  if (!(Math.min(...scale.toArray()) >= SHORTEST)) return undefined;
  axes.forEach((one) => one.normalize());
  const cosines = axes.map((one, i) => Math.abs(one.dot(axes[(i + 1) % 3] ?? one)));
  if (Math.max(...cosines) > SHEAR) return undefined;
  if (new Vector3().crossVectors(axes[0], axes[1]).dot(axes[2]) < 0) {
    scale.x = -scale.x;
    axes[0].negate();
  }
  const { x, y, z, w } = new Quaternion().setFromRotationMatrix(new Matrix4().makeBasis(...axes)).normalize();
  return { translation: plain(new Vector3().setFromMatrixPosition(matrix)), rotation: { x, y, z, w }, scale: plain(scale) };
}

// The triangles where the matrix puts them; those that it mirrors are turned round again.
export function baked(triangles: Triangles, matrix: Matrix4): Triangles {
  const moved = (values: Float32Array, by: (vector: Vector3) => Vector3): Float32Array => {
    const out = new Float32Array(values.length);
    for (let i = 0; i < values.length; i += 3) by(new Vector3().fromArray(values, i)).toArray(out, i);
    return out;
  };
  const indices = triangles.indices.slice();
  if (matrix.determinant() < 0) {
    for (let i = 0; i + 2 < indices.length; i += 3) indices.subarray(i + 1, i + 3).reverse();
  }
  const ofNormals = matrix.determinant() === 0 ? new Matrix3().setFromMatrix4(matrix) : new Matrix3().getNormalMatrix(matrix);
  return {
    ...triangles, indices, positions: moved(triangles.positions, (at) => at.applyMatrix4(matrix)),
    ...(triangles.normals ? { normals: moved(triangles.normals, (normal) => normal.applyMatrix3(ofNormals)) } : {}),
  };
}

// A mesh at the place that a matrix gives it.
export function placed(triangles: Triangles, matrix: Matrix4): Pick<Part, "triangles" | "placement"> {
  const placement = placementFrom(matrix);
  return placement ? { triangles, placement } : { triangles: baked(triangles, matrix), placement: NO_PLACEMENT };
}

type Axis = "x" | "y" | "z";
const AXES: readonly Axis[] = ["x", "y", "z"];

// The corners of the box in the world around all of the parts.
function bounds(parts: readonly Part[]): { min: Vector3; max: Vector3 } {
  const min = new Vector3(Infinity, Infinity, Infinity);
  const max = new Vector3(-Infinity, -Infinity, -Infinity);
  const at = new Vector3();
  for (const { triangles: { positions }, placement: { translation, rotation, scale } } of parts) {
    const turn = new Quaternion(rotation.x, rotation.y, rotation.z, rotation.w);
    for (let i = 0; i < positions.length; i += 3) {
      at.fromArray(positions, i).multiply(scale as Vector3).applyQuaternion(turn).add(translation as Vector3);
      min.min(at);
      max.max(at);
    }
  }
  return { min, max };
}

// The parts in the middle of the box where they are not within it, all moved by the same.
export function broughtInto(parts: Part[], box: Box | undefined): Part[] {
  const low = box?.min;
  const high = box?.max;
  if (!low || !high || parts.length === 0) return parts;
  const { min, max } = bounds(parts);
  if (AXES.every((axis) => min[axis] >= low[axis] && max[axis] <= high[axis])) return parts;
  const by = (axis: Axis): number => (low[axis] + high[axis] - min[axis] - max[axis]) / 2;
  return parts.map((part) => {
    const { x, y, z } = part.placement.translation;
    return { ...part, placement: { ...part.placement, translation: { x: x + by("x"), y: y + by("y"), z: z + by("z") } } };
  });
}
