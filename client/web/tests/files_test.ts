import assert from "node:assert/strict";
import { test } from "node:test";
import { Matrix4, Quaternion, Vector3 } from "three";
import { TextureFormat } from "../gen/lpv/v1/blob_pb.ts";
import { bytesWithin, DroppedFiles } from "../src/scene/files/dropped_files.ts";
import { readGltf } from "../src/scene/files/gltf.ts";
import { fileIn } from "../src/scene/files/mtl.ts";
import { readObj } from "../src/scene/files/obj.ts";
import { inEdits } from "../src/scene/files/operations.ts";
import { NO_PLACEMENT, objectName, plainMaterial, white, type Part, type Triangles } from "../src/scene/files/parts.ts";
import { baked, broughtInto, placementFrom } from "../src/scene/files/place.ts";
import { sceneOf } from "../src/scene/files/read.ts";
import { pictureOf } from "../src/scene/files/texels.ts";

const triangle: Triangles = { positions: Float32Array.of(0, 0, 0, 1, 0, 0, 0, 1, 0), indices: Uint32Array.of(0, 1, 2), normals: Float32Array.of(0, 0, 1, 0, 0, 1, 0, 0, 1) };
const part = (name: string, radiance: number): Part =>
  ({ name, triangles: triangle, placement: NO_PLACEMENT, material: { ...plainMaterial(), radiance: white(radiance), doubleSided: true } });

// Of triangles in the plane of x and y: those that are seen from their front minus the others, and all together.
function areas({ positions, indices }: Triangles): { front: number; all: number } {
  const at = (i: number): Vector3 => new Vector3().fromArray(positions, 3 * (indices[i] ?? 0));
  const sums = { front: 0, all: 0 };
  for (let i = 0; i < indices.length; i += 3) {
    const area = at(i + 1).sub(at(i)).cross(at(i + 2).sub(at(i))).z / 2;
    sums.front += area;
    sums.all += Math.abs(area);
  }
  return sums;
}

const objOf = (...lines: string[]): Promise<{ parts: Part[] }> => {
  const file = new File([lines.join("\n")], "thing.obj");
  return readObj(file, new DroppedFiles([file]), []);
};

test("what emits becomes a light and the rest surfaces; where nothing does, all become lights", () => {
  const mixed = sceneOf("a.glb", { parts: [part("wall", 0), part("lamp", 3)], cameras: [] });
  assert.deepEqual([mixed.lights.map(({ name }) => name), mixed.surfaces.map(({ name }) => name)], [["lamp"], ["wall"]]);
  const dark = sceneOf("a.glb", { parts: [part("wall", 0), part("floor", 0)], cameras: [] });
  assert.deepEqual([dark.lights.length, dark.surfaces.length], [2, 0]);
  assert.deepEqual(dark.lights[0]?.material.radiance, white(5));
  assert.equal(dark.lights[0]?.material.doubleSided, true);
});

test("names are those that a session takes", () => {
  assert.equal(objectName(undefined, "", "stem"), "stem");
  assert.equal(objectName("<root>", "a/b\u0007c"), "a_b_c");
  assert.equal(objectName(""), "object");
  assert.equal(new TextEncoder().encode(objectName("é".repeat(150))).length, 200);
});

test("a file that another names is found by its last part, and belongs to it", () => {
  const [wood, other] = [new File([], "wood 1.png"), new File([], "other.png")];
  const files = new DroppedFiles([wood, other]);
  assert.equal(files.find("..\\textures/wood%201.png"), wood);
  assert.equal(files.find("100%.png"), undefined);
  assert.deepEqual([files.isPartOfAnother(wood), files.isPartOfAnother(other)], [true, false]);
  assert.deepEqual([...(bytesWithin("data:application/octet-stream;base64,AQID") ?? [])], [1, 2, 3]);
  assert.equal(bytesWithin("wood.png"), undefined);
});

test("a placement says what its matrix does; one that shears is baked", () => {
  const matrix = new Matrix4().compose(new Vector3(1, 2, 3), new Quaternion(0.1, 0.2, 0.3, 0.9).normalize(), new Vector3(-2, 3, 0.5));
  const { translation: t, rotation: r, scale: s } = placementFrom(matrix) ?? NO_PLACEMENT;
  const again = new Matrix4().compose(new Vector3(t.x, t.y, t.z), new Quaternion(r.x, r.y, r.z, r.w), new Vector3(s.x, s.y, s.z));
  again.elements.forEach((value, i) => assert.ok(Math.abs(value - (matrix.elements[i] ?? 0)) < 1e-9));
  const shear = new Matrix4().makeShear(0.5, 0, 0, 0, 0, 0);
  assert.equal(placementFrom(shear), undefined);
  assert.equal(placementFrom(new Matrix4().makeScale(1, 0, 1)), undefined);
  const mirrored = baked(triangle, new Matrix4().makeScale(-2, 1, 1));
  assert.equal(areas(mirrored).front, 1, "still counter-clockwise from the front");
  assert.deepEqual([...(mirrored.normals ?? [])].slice(0, 3).map(Math.abs), [0, 0, 1]);
});

test("parts outside the box come into its middle together", () => {
  const vector = (x: number, y: number, z: number) => ({ $typeName: "lpv.v1.Vec3" as const, x, y, z });
  const box = { $typeName: "lpv.v1.Box" as const, min: vector(10, 10, 10), max: vector(14, 14, 14) };
  const far = { ...part("b", 1), placement: { ...NO_PLACEMENT, translation: { x: 1, y: 0, z: 0 } } };
  const [a, b] = broughtInto([part("a", 1), far], box);
  assert.deepEqual([a?.placement.translation, b?.placement.translation], [{ x: 11, y: 11.5, z: 12 }, { x: 12, y: 11.5, z: 12 }]);
  const inside = [{ ...part("a", 1), placement: { ...NO_PLACEMENT, translation: { x: 11, y: 11, z: 12 } } }];
  assert.equal(broughtInto(inside, box), inside);
});

test("texels are those that their use wants", () => {
  const rgba = Uint8Array.of(1, 2, 3, 255, 4, 5, 6, 9);
  assert.deepEqual(pictureOf(rgba, 2, 1, "colour"), { width: 2, height: 1, format: TextureFormat.RGB8_SRGB, texels: Uint8Array.of(1, 2, 3, 4, 5, 6) });
  assert.equal(pictureOf(rgba, 2, 1, "numbers").format, TextureFormat.RGB8_LINEAR);
  assert.deepEqual(pictureOf(rgba, 2, 1, "colour with alpha").texels, rgba);
  assert.equal(pictureOf(rgba.fill(255), 2, 1, "colour with alpha").format, TextureFormat.RGB8_SRGB);
});

test("an OBJ is cut by object and material, and its polygons by their outline", async () => {
  const corners = ["v 0 0 0", "v 2 0 0", "v 2 2 0", "v 1 0.5 0", "vt 0 0.25"];
  const { parts } = await objOf(...corners, "o first thing", "usemtl a", "f 1 2 3 4", "usemtl b", "f -4/1 -3/1 \\", "-2/1 # and a comment", "g second thing", "f 1 2 3");
  assert.deepEqual(parts.map(({ name }) => name), ["first", "first", "second thing"]);
  const [bent, plain] = parts;
  assert.ok(bent && plain);
  assert.ok(Math.abs(areas(bent.triangles).all - 1.5) < 1e-6, "the dent is not filled");
  assert.deepEqual([...(plain.triangles.uvs ?? [])].slice(0, 2), [0, 0.75], "v goes down");
  assert.equal(plain.material.albedo.x, 0.6);
  await assert.rejects(objOf("v 0 0 0", "f 1 2 3"), /thing\.obj, line 2: vertex 2 is out of range/);
  await assert.rejects(objOf("v 0 0"), /line 1: a vertex needs 3 numbers/);
  await assert.rejects(objOf("v 0 0 0", "f a b c"), /'a' is no corner of a face/);
});

test("a texture's options are not its name", () => {
  assert.equal(fileIn("wood.png"), "wood.png");
  assert.equal(fileIn("-clamp on -s 2 2 -bm 0.5 my wood.png"), "my wood.png");
  assert.equal(fileIn("-o 1 2 3 wood.png"), "wood.png");
});

test("glTF strips and fans become triangles; what is wrong is named", async () => {
  const positions = new Float32Array([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0]);
  const json = (mode: number, more = {}) => ({
    asset: { version: "2.0" }, nodes: [{ mesh: 0 }], meshes: [{ name: "quad", primitives: [{ attributes: { POSITION: 0 }, mode }] }],
    accessors: [{ bufferView: 0, componentType: 5126, count: 4, type: "VEC3" }], bufferViews: [{ buffer: 0, byteLength: 48 }],
    buffers: [{ uri: `data:;base64,${Buffer.from(positions.buffer).toString("base64")}`, byteLength: 48 }], ...more,
  });
  const read = (content: unknown): Promise<{ parts: Part[] }> => {
    const file = new File([JSON.stringify(content)], "thing.gltf");
    return readGltf(file, new DroppedFiles([file]), []);
  };
  const [strip] = (await read(json(5))).parts;
  assert.equal(strip?.name, "quad");
  assert.deepEqual([...(strip?.triangles.indices ?? [])], [0, 1, 2, 2, 1, 3]);
  assert.deepEqual([...((await read(json(6))).parts[0]?.triangles.indices ?? [])], [0, 1, 2, 0, 2, 3]);
  assert.deepEqual((await read(json(1))).parts, []);
  assert.deepEqual([strip?.material.albedo, strip?.material.metalness, strip?.material.oneSidedSurface], [white(1), 1, true]);
  await assert.rejects(read(json(4, { accessors: [{ bufferView: 0, componentType: 5126, count: 5, type: "VEC3" }] })), /thing\.gltf is cut short/);
  await assert.rejects(read(json(4, { accessors: [] })), /refers to accessors\[0\], which it does not have/);
  await assert.rejects(read({ asset: { version: "1.0" } }), /version 1\.0/);
  await assert.rejects(read(json(4, { extensionsRequired: ["EXT_mesh_gpu_instancing"] })), /requires EXT_mesh_gpu_instancing, which the page does not read/);
  await assert.rejects(read(json(4, { nodes: [{ mesh: 0, children: [0] }], scenes: [{ nodes: [0] }] })), /nodes\[0\] is reached twice/);
});

test("edits have at most 1000 operations and 900,000 bytes", () => {
  const remove = (name: string) => ({ operation: { case: "deleteLight" as const, value: name } });
  assert.deepEqual(inEdits(Array.from({ length: 2500 }, () => remove("a"))).map(({ length }) => length), [1000, 1000, 500]);
  assert.deepEqual(inEdits(Array.from({ length: 5 }, () => remove("a".repeat(400_000)))).map(({ length }) => length), [2, 2, 1]);
});
