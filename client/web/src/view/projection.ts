import type { Point, View } from "./camera_rig.ts";

const NEAR = 0.02; // metres before the eye, from where on something is seen

export type Pixel = readonly [number, number];

// Pixels of a picture of this size, from points of the world.
export class Projection {
  private readonly axes: Axes;
  private readonly scale: number;

  constructor(private readonly view: View, private readonly width: number, private readonly height: number) {
    this.axes = axesOf(view);
    this.scale = height / (2 * Math.tan((view.fovDegrees * Math.PI) / 360));
  }

  // Nothing behind the eye.
  point(at: Point): Pixel | undefined {
    const seen = this.fromEye(at);
    return seen.z < NEAR ? undefined : this.pixel(seen);
  }

  // The part of the way from one point to the other that is before the eye.
  line(from: Point, to: Point): readonly [Pixel, Pixel] | undefined {
    const a = this.fromEye(from);
    const b = this.fromEye(to);
    if (a.z < NEAR && b.z < NEAR) return undefined;
    return [this.pixel(cut(a, b)), this.pixel(cut(b, a))];
  }

  // z: ahead.
  private fromEye(at: Point): Point {
    const way = minus(at, this.view.eye);
    const { right, up, ahead } = this.axes;
    return { x: dot(way, right), y: dot(way, up), z: dot(way, ahead) };
  }

  private pixel({ x, y, z }: Point): Pixel {
    return [this.width / 2 + (this.scale * x) / z, this.height / 2 - (this.scale * y) / z];
  }
}

// From metres to the camera's right, upwards and ahead.
export function worldFromCamera(view: View, { x, y, z }: Point): Point {
  const { right, up, ahead } = axesOf(view);
  return plus(plus(plus(view.eye, right, x), up, y), ahead, z);
}

interface Axes {
  right: Point;
  up: Point;
  ahead: Point;
}

function axesOf({ eye, target }: View): Axes {
  const ahead = unit(minus(target, eye));
  const right = unit({ x: -ahead.z, y: 0, z: ahead.x });
  return { right, up: cross(right, ahead), ahead };
}

function cut(a: Point, towards: Point): Point {
  if (a.z >= NEAR) return a;
  const share = (NEAR - a.z) / (towards.z - a.z);
  return { x: a.x + share * (towards.x - a.x), y: a.y + share * (towards.y - a.y), z: NEAR };
}

const plus = (a: Point, b: Point, by: number): Point => ({ x: a.x + by * b.x, y: a.y + by * b.y, z: a.z + by * b.z });
const minus = (a: Point, b: Point): Point => ({ x: a.x - b.x, y: a.y - b.y, z: a.z - b.z });
const dot = (a: Point, b: Point): number => a.x * b.x + a.y * b.y + a.z * b.z;
const cross = (a: Point, b: Point): Point => ({ x: a.y * b.z - a.z * b.y, y: a.z * b.x - a.x * b.z, z: a.x * b.y - a.y * b.x });

function unit(a: Point): Point {
  const length = Math.hypot(a.x, a.y, a.z) || 1;
  return { x: a.x / length, y: a.y / length, z: a.z / length };
}
