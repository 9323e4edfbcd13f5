import assert from "node:assert/strict";
import { test } from "node:test";
import { create } from "@bufbuild/protobuf";
import { CameraSchema } from "../gen/lpv/v1/geometry_pb.ts";
import { LightSchema, SceneChangeSchema, SceneSnapshotSchema } from "../gen/lpv/v1/scene_pb.ts";
import { CameraRig } from "../src/view/camera_rig.ts";
import { fromHex, fromKelvins, lumens, radianceOf, scaled, toHex, toKelvins, watts } from "../src/scene/emission.ts";
import { SceneModel } from "../src/scene/model.ts";
import { anglesOf, carried, rotationOf, type Placement } from "../src/scene/placement.ts";
import { sphere } from "../src/scene/shapes.ts";

const near = (a: number, b: number, tolerance = 1e-9): void => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);

test("parts of a snapshot and of a change are shown as one", () => {
  const model = new SceneModel();
  let told = 0;
  model.onChange(() => (told += 1));
  const light = (name: string) => create(LightSchema, { name });
  model.takeSnapshot(create(SceneSnapshotSchema, { revision: 5n, epoch: 1n, lights: [light("a")], more: true }));
  assert.equal(model.revision, 0n);
  model.takeSnapshot(create(SceneSnapshotSchema, { revision: 5n, epoch: 1n, lights: [light("b")], cameras: [create(CameraSchema, { name: "c" })] }));
  assert.deepEqual([[...model.lights.keys()], told, model.revision], [["a", "b"], 1, 5n]);
  model.takeChange(create(SceneChangeSchema, { lastRevision: 6n, deletedLights: ["a"], lights: [light("d")] }));
  assert.deepEqual([[...model.lights.keys()], told, model.revision], [["b", "d"], 2, 6n]);
});

test("a snapshot that broke off is told again from nothing", () => {
  const model = new SceneModel();
  model.takeSnapshot(create(SceneSnapshotSchema, { revision: 5n, lights: [create(LightSchema, { name: "a" })] }));
  model.takeSnapshot(create(SceneSnapshotSchema, { revision: 7n, lights: [create(LightSchema, { name: "b" })], more: true }));
  assert.equal(model.revision, 0n);
  model.beginWatch();
  model.takeSnapshot(create(SceneSnapshotSchema, { revision: 8n, lights: [create(LightSchema, { name: "c" })] }));
  assert.deepEqual([...model.lights.keys()], ["c"]);
});

test("power is pi times area times radiance, light 179 lm/W of the luminance", () => {
  const radiance = { x: 1, y: 2, z: 3 };
  near(watts(radiance, 2), 12 * Math.PI);
  near(lumens({ x: 1, y: 1, z: 1 }, 2), 179 * 2 * Math.PI, 1e-6);
  const light = create(LightSchema, { emission: { case: "power", value: { x: 4 * Math.PI, y: 0, z: 0 } } });
  near(radianceOf(light, 2).x, 2);
});

test("a colour comes back from the picker as it went in", () => {
  assert.equal(toHex({ x: 14, y: 14, z: 14 }), "#ffffff");
  for (const hex of ["#ff8000", "#12ff9a", "#0000ff"]) assert.equal(toHex(fromHex(hex)), hex);
});

test("a temperature is a black body's colour, and comes back", () => {
  const daylight = fromKelvins(6504);
  assert.ok(Math.abs(daylight.y / daylight.x - 0.943) < 2e-3 && Math.abs(daylight.z / daylight.x - 0.993) < 2e-3, "x .3135, y .3236");
  const candle = fromKelvins(1900), sky = fromKelvins(15000);
  assert.ok(candle.x === 1 && candle.y < 0.35 && candle.z < 0.02, "1,900 K is orange");
  assert.ok(sky.z === 1 && sky.x < 0.55 && sky.x < sky.y, "15,000 K is blue");
  const lamp = fromKelvins(2856); // CIE's illuminant A: x .4476, y .4074
  const [X, Y, Z] = [0.4124564 * lamp.x + 0.3575761 * lamp.y + 0.1804375 * lamp.z,
    0.2126729 * lamp.x + 0.7151522 * lamp.y + 0.072175 * lamp.z, 0.0193339 * lamp.x + 0.119192 * lamp.y + 0.9503041 * lamp.z];
  assert.ok(Math.abs(X / (X + Y + Z) - 0.4476) < 1e-3 && Math.abs(Y / (X + Y + Z) - 0.4074) < 1e-3);
  for (const kelvins of [1800, 2700, 4000, 6500, 12000]) {
    const found = toKelvins(scaled(fromKelvins(kelvins), 7));
    assert.ok(found !== undefined && Math.abs(found / kelvins - 1) < 0.01, `${kelvins} K`);
  }
  assert.equal(toKelvins({ x: 0, y: 1, z: 0 }), undefined, "green is no black body's");
});

test("angles and rotation are one another's inverse", () => {
  for (const angles of [{ x: 30, y: -40, z: 100 }, { x: -170, y: 80, z: 5 }]) {
    const back = anglesOf(rotationOf(angles));
    near(back.x, angles.x, 1e-9);
    near(back.y, angles.y, 1e-9);
    near(back.z, angles.z, 1e-9);
  }
  const turned = rotationOf({ x: 0, y: 90, z: 0 });
  near(turned.y, Math.SQRT1_2);
});

test("a camera keeps its view when it is set, its distance when it orbits, its eye when it looks around", () => {
  const rig = new CameraRig();
  const view = { eye: { x: 3, y: 2, z: -1 }, target: { x: 0, y: 1, z: 0.5 }, fovDegrees: 38 };
  const distance = (v: typeof view) => Math.hypot(v.eye.x - v.target.x, v.eye.y - v.target.y, v.eye.z - v.target.z);
  rig.set(view);
  near(rig.view().eye.x, 3);
  near(rig.view().eye.y, 2);
  near(rig.view().eye.z, -1);
  rig.look(0.3, 0.1);
  near(rig.view().eye.x, 3);
  near(rig.view().eye.z, -1);
  rig.orbit(1, 5);
  near(distance(rig.view()), distance(view));
  rig.dolly(0.5);
  near(distance(rig.view()), distance(view) / 2);
});

test("the sphere's triangles face outwards, and it is closed", () => {
  const { positions, indices } = sphere(8, 12);
  const at = new Float32Array(positions.buffer);
  const corners = new Uint32Array(indices.buffer);
  const point = (i: number) => [at[3 * i] ?? 0, at[3 * i + 1] ?? 0, at[3 * i + 2] ?? 0] as const;
  let volume = 0;
  for (let i = 0; i < corners.length; i += 3) {
    const [a, b, c] = [point(corners[i] ?? 0), point(corners[i + 1] ?? 0), point(corners[i + 2] ?? 0)];
    const six = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    assert.ok(six > 0);
    volume += six / 6;
  }
  assert.ok(volume > 0.45 && volume < Math.PI / 6);
});

const at = (x: number, y: number, z: number): Placement["translation"] => ({ x, y, z });
const close = (a: object, b: object): void => Object.entries(b).forEach(([key, value]) => near((a as Record<string, number>)[key] ?? NaN, value as number));

// Broken by: turning the wrong way, growth along the world's axes, a turn on the wrong side.
test("what goes along keeps its place beside what leads", () => {
  const still: Placement = { translation: at(1, 0, 0), rotation: { x: 0, y: 0, z: 0, w: 1 }, scale: at(1, 1, 1) };
  const other: Placement = { translation: at(3, 1, 0), rotation: rotationOf(at(10, 20, 30)), scale: at(1, 2, 3) };
  close(carried(other, still, { ...still, translation: at(1, 5, 0) }).translation, at(3, 6, 0));
  const quarter = rotationOf(at(0, 90, 0));
  const turned = carried(other, still, { ...still, rotation: quarter });
  close(turned.translation, at(1, 1, -2));
  const again = carried(turned, { ...still, rotation: quarter }, still);
  close(again.translation, other.translation);
  close(again.rotation, other.rotation);
  close(carried(other, still, { ...still, scale: at(2, 1, 1) }).translation, at(5, 1, 0));
  close(carried(other, still, { ...still, scale: at(2, 1, 1) }).scale, at(2, 2, 3));
  const lying = carried({ ...other, rotation: rotationOf(at(0, 0, 90)) }, still, { ...still, rotation: rotationOf(at(90, 0, 0)) });
  close(lying.rotation, { x: 0.5, y: -0.5, z: 0.5, w: 0.5 });
  const leads: Placement = { ...still, rotation: quarter };
  close(carried(other, leads, { ...leads, scale: at(1, 1, 2) }).translation, at(5, 1, 0));
});
