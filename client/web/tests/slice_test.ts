import assert from "node:assert/strict";
import { test } from "node:test";
import { create } from "@bufbuild/protobuf";
import { VolumeHeaderSchema } from "../gen/lpv/v1/volume_pb.ts";
import { Field } from "../src/local/field.ts";
import { fromHalf, sliceOf } from "../src/local/slice.ts";

const ONE = 0x3c00, TEN_THOUSANDTH = 0x068e, ROOT_3 = 0x3eee; // half floats

test("half floats are read as IEEE 754 has them", () => {
  assert.deepEqual([ONE, 0xc000, 0x0001, 0x7bff, 0x7c00].map(fromHalf), [1, -2, 2 ** -24, 65504, Infinity]);
  assert.ok(Number.isNaN(fromHalf(0x7c01)));
});

// 3 x 2 x 1 cells with one guard cell around them; scale 2.
function field(): Field {
  return new Field(create(VolumeHeaderSchema, {
    grid: { dims: { x: 3, y: 2, z: 1 }, cellSize: 0.5, origin: { x: 0, y: 0, z: 0 } }, guardCells: 1, layers: [{ scale: 2 }],
  }));
}
function put(to: Field, x: number, y: number, z: number, coefficients: number[]): void {
  const [nx, ny] = to.dims;
  for (const halves of to.colours) halves.set(coefficients, 4 * (((z + 1) * ny + y + 1) * nx + x + 1));
}
const pixel = (rgba: Uint8ClampedArray, i: number): number[] => [...rgba.slice(4 * i, 4 * i + 3)];

test("a slice from the front has up above, and its largest fluence is yellow", () => {
  const f = field();
  put(f, 2, 1, 0, [ONE, 0, 0, 0]);
  put(f, 0, 0, 0, [TEN_THOUSANDTH, 0, 0, 0]);
  const slice = sliceOf(f, 2, 0, "fluence");
  assert.deepEqual([slice.width, slice.height], [3, 2]);
  assert.ok(Math.abs(slice.largest - 2 * Math.sqrt(4 * Math.PI)) < 1e-6);
  assert.deepEqual(pixel(slice.rgba, 2), [253, 231, 37], "upper right");
  assert.deepEqual(pixel(slice.rgba, 3), [68, 1, 84], "lower left: four decades down");
  assert.deepEqual(pixel(slice.rgba, 0), [68, 1, 84], "no light");
});

test("by direction light from +x is red, from all around grey", () => {
  const f = field();
  put(f, 0, 0, 0, [ONE, 0, 0, ROOT_3]);
  put(f, 1, 0, 0, [ONE, 0, 0, 0]);
  const slice = sliceOf(f, 1, 0, "direction");
  const [red = 0, green = 0, blue = 0] = pixel(slice.rgba, 0);
  assert.ok(red === 255 && Math.abs(green - 128) <= 1 && Math.abs(blue - 128) <= 1);
  const [r = 0, g = 0, b = 0] = pixel(slice.rgba, 1);
  assert.ok(Math.abs(r - 128) <= 1 && r === g && g === b);
});
