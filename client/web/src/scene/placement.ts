import type { Transform } from "../../gen/lpv/v1/geometry_pb.ts";

// World from object, all three said.
export interface Placement {
  translation: { x: number; y: number; z: number };
  rotation: { x: number; y: number; z: number; w: number };
  scale: { x: number; y: number; z: number };
}

export function placementOf(transform: Transform | undefined): Placement {
  return {
    translation: transform?.translation ?? { x: 0, y: 0, z: 0 },
    rotation: transform?.rotation ?? { x: 0, y: 0, z: 0, w: 1 },
    scale: transform?.scale ?? { x: 1, y: 1, z: 1 },
  };
}

export interface Angles {
  x: number;
  y: number;
  z: number;
}

const DEGREES = 180 / Math.PI;

// Degrees about x, then y, then z of the world.
export function anglesOf({ x, y, z, w }: Placement["rotation"]): Angles {
  const sine = Math.min(1, Math.max(-1, 2 * (w * y - z * x)));
  return {
    x: DEGREES * Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    y: DEGREES * Math.asin(sine),
    z: DEGREES * Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
  };
}

export function rotationOf(angles: Angles): Placement["rotation"] {
  const half = (degrees: number): [number, number] => [Math.cos(degrees / DEGREES / 2), Math.sin(degrees / DEGREES / 2)];
  const [cx, sx] = half(angles.x);
  const [cy, sy] = half(angles.y);
  const [cz, sz] = half(angles.z);
  return {
    x: sx * cy * cz - cx * sy * sz, y: cx * sy * cz + sx * cy * sz,
    z: cx * cy * sz - sx * sy * cz, w: cx * cy * cz + sx * sy * sz,
  };
}
