import type { OperationInit } from "./editor.ts";
import { sphere, square } from "./shapes.ts";

type Triple = [number, number, number];
const HALF = Math.SQRT1_2;
const FACING_UP = { x: -HALF, y: 0, z: 0, w: HALF };
const FACING_DOWN = { x: HALF, y: 0, z: 0, w: HALF };
const FACING_RIGHT = { x: 0, y: HALF, z: 0, w: HALF };
const FACING_LEFT = { x: 0, y: -HALF, z: 0, w: HALF };
const FACING_FRONT = { x: 0, y: 0, z: 0, w: 1 };

const vec = ([x, y, z]: Triple) => ({ x, y, z });

function surface(name: string, inlineMesh: ReturnType<typeof square>, at: Triple, rotation: typeof FACING_UP, scale: Triple,
  albedo: Triple): OperationInit {
  const transform = { translation: vec(at), rotation, scale: vec(scale) };
  return { operation: { case: "createSurface", value: { name, inlineMesh, transform, albedo: vec(albedo) } } };
}

// A room of five walls, open to the front, with a light under the ceiling and a ball on the floor. Metres.
export function demoRoom(): OperationInit[] {
  const white: Triple = [0.75, 0.74, 0.72];
  return [
    surface("floor", square(), [0, 0, 0], FACING_UP, [4, 4, 1], [0.55, 0.5, 0.45]),
    surface("ceiling", square(), [0, 3, 0], FACING_DOWN, [4, 4, 1], white),
    surface("back wall", square(), [0, 1.5, -2], FACING_FRONT, [4, 3, 1], white),
    surface("left wall", square(), [-2, 1.5, 0], FACING_RIGHT, [4, 3, 1], [0.65, 0.2, 0.15]),
    surface("right wall", square(), [2, 1.5, 0], FACING_LEFT, [4, 3, 1], [0.2, 0.45, 0.25]),
    surface("ball", sphere(), [0.6, 0.6, -0.3], FACING_FRONT, [1.2, 1.2, 1.2], [0.8, 0.8, 0.8]),
    {
      operation: {
        case: "createLight",
        value: {
          name: "lamp", inlineMesh: square(),
          transform: { translation: vec([0, 2.7, 0]), rotation: FACING_DOWN, scale: vec([1.2, 0.8, 1]) },
          emission: { case: "radiance", value: vec([14, 12, 9]) },
        },
      },
    },
    {
      operation: {
        case: "putCamera",
        value: { name: "front", eye: vec([0, 1.5, 6.6]), target: vec([0, 1.45, 0]), fovDegrees: 38 },
      },
    },
    { operation: { case: "fitGrid", value: {} } },
  ];
}
