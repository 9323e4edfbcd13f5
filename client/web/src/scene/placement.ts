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

export type Vector = Placement["translation"];
export type Rotation = Placement["rotation"];

export const times = (a: Rotation, b: Rotation): Rotation => ({
  x: a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, y: a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
  z: a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, w: a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
});

export const back = ({ x, y, z, w }: Rotation): Rotation => ({ x: -x, y: -y, z: -z, w });

export function turned(v: Vector, by: Rotation): Vector {
  const { x, y, z } = times(times(by, { ...v, w: 0 }), back(by));
  return { x, y, z };
}

const each = (a: Vector, b: Vector, join: (a: number, b: number) => number): Vector => ({ x: join(a.x, b.x), y: join(a.y, b.y), z: join(a.z, b.z) });
const sum = (a: number, b: number): number => a + b;
const product = (a: number, b: number): number => a * b;

// Where an object comes to that goes along with another one's way from one place to the next: it keeps its place in what
// the other sees along its axes, which may grow.
export function carried(object: Placement, from: Placement, to: Placement): Placement {
  const factor = each(to.scale, from.scale, (after, before) => (before === 0 ? 1 : after / before));
  const seen = turned(each(object.translation, from.translation, (a, b) => a - b), back(from.rotation));
  const turn = times(to.rotation, back(from.rotation));
  return {
    translation: each(to.translation, turned(each(seen, factor, product), to.rotation), sum),
    rotation: times(turn, object.rotation),
    scale: each(object.scale, factor, product),
  };
}
