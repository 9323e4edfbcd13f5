import assert from "node:assert/strict";
import { test } from "node:test";
import { nudged, type Nudge } from "../src/scene/nudge.ts";
import { rotationOf, type Placement } from "../src/scene/placement.ts";

const at: Placement = { translation: { x: 0.34, y: 1, z: -0.3 }, rotation: rotationOf({ x: 0, y: 90, z: 0 }), scale: { x: 1, y: 0.04, z: -1 } };
const step: Nudge = { mode: "translate", space: "world", snap: false, axis: "x", way: 1, fine: false };
const near = (a: number, b: number): void => assert.ok(Math.abs(a - b) < 1e-6, `${a}, not ${b}`);

test("a step moves along the world's axes or the object's own", () => {
  near(nudged(at, step).translation.x, 0.44);
  near(nudged(at, { ...step, fine: true, way: -1 }).translation.x, 0.33);
  const own = nudged(at, { ...step, space: "local" }).translation;
  near(own.x, 0.34);
  near(own.z, -0.4); // a quarter turn about y
});

test("with snap a step ends at a multiple, and a multiple is left", () => {
  const snapped = nudged(at, { ...step, snap: true });
  near(snapped.translation.x, 0.4);
  near(nudged(snapped, { ...step, snap: true }).translation.x, 0.5);
  near(nudged(at, { ...step, snap: true, way: -1 }).translation.x, 0.3);
  near(nudged(at, { ...step, snap: true, axis: "z", way: -1 }).translation.z, -0.4);
});

test("a size changes by a share of it, and never its sign", () => {
  const size: Nudge = { ...step, mode: "scale" };
  near(nudged(nudged(at, size), { ...size, way: -1 }).scale.x, 1);
  near(nudged(at, { ...size, axis: "z" }).scale.z, -1.1);
  near(nudged(at, { ...size, axis: "y", way: -1, snap: true }).scale.y, 0.04);
});
