import assert from "node:assert/strict";
import { test } from "node:test";
import { Vector3 } from "three";
import { smoothNormals } from "../src/scene/files/normals.ts";
import type { Triangles } from "../src/scene/files/parts.ts";
import { plyMesh } from "../src/scene/files/ply.ts";
import { appendTriangles } from "../src/scene/files/polygons.ts";

const near = (a: number, b: number, tolerance = 1e-6): void => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);
const encoded = (text: string): Uint8Array => new TextEncoder().encode(text);

function areaOf({ positions, indices }: Triangles): number {
  let area = 0;
  for (let i = 0; i < indices.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => new Vector3().fromArray(positions, 3 * indices[i + k]!)) as [Vector3, Vector3, Vector3];
    area += b.sub(a).cross(c.sub(a)).length() / 2;
  }
  return area;
}

test("a polygon with a notch becomes triangles that cover it and no more", () => {
  const points = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [1, 0.5, 0], [0, 2, 0]].map((v) => new Vector3(...(v as [number, number, number])));
  const turned = points.map((point) => point.clone().applyAxisAngle(new Vector3(0.6, 0, 0.8), 2));
  for (const corners of [points, turned]) {
    const out: number[] = [];
    appendTriangles([0, 1, 2, 3, 4], (corner) => corners[corner]!, out);
    assert.equal(out.length, 9);
    near(areaOf({ positions: Float32Array.from(corners.flatMap((p) => p.toArray())), indices: Uint32Array.from(out) }), 2.5, 1e-5);
  }
});

test("PLY: faces before vertices, strips, both orders of bytes, texture coordinates from the bottom", () => {
  const head = (format: string): string => ["ply", `format ${format} 1.0`, "element vertex 4", "property float x", "property float y", "property float z",
    "property float s", "property float t", "element tristrips 1", "property list uchar int vertex_indices", "end_header", ""].join("\n");
  const corners = [[0, 0, 0, 0, 0], [1, 0, 0, 1, 0], [0, 1, 0, 0, 1], [1, 1, 0, 1, 1]];
  for (const little of [true, false]) {
    const body = new DataView(new ArrayBuffer(4 * 20 + 1 + 16));
    corners.flat().forEach((value, i) => body.setFloat32(4 * i, value, little));
    body.setUint8(80, 4);
    [0, 1, 2, 3].forEach((corner, i) => body.setInt32(81 + 4 * i, corner, little));
    const header = encoded(head(`binary_${little ? "little" : "big"}_endian`));
    const mesh = plyMesh(Uint8Array.from([...header, ...new Uint8Array(body.buffer)]));
    assert.deepEqual([...mesh.indices], [0, 1, 2, 2, 1, 3]);
    assert.deepEqual([...(mesh.uvs ?? [])], [0, 1, 1, 1, 0, 0, 1, 0]);
    assert.deepEqual([...(mesh.normals ?? [])].slice(0, 3), [0, 0, 1]);
    assert.throws(() => plyMesh(Uint8Array.from([...header, ...new Uint8Array(body.buffer, 0, 90)])), /cut short: 0 complete elements of "tristrips"/);
  }
  const faceFirst = "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_index\nelement vertex 3\nproperty float x\nproperty float y\n"
    + "property float z\nend_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n";
  near(areaOf(plyMesh(encoded(faceFirst))), 0.5);
  assert.throws(() => plyMesh(encoded(faceFirst.replace("3 0 1 2", "3 0 1 7"))), /face 0: vertex 7 is out of range; the file has 3 vertices/);
  assert.throws(() => plyMesh(encoded("ply\nformat ascii 1.0\n")), /header is not complete/);
  near(areaOf(plyMesh(encoded(faceFirst.replace("end_header", "element nothing 1000000000000\nend_header")))), 0.5);
});

test("smooth normals go by places, not by numbers of vertices", () => {
  const positions = Float32Array.of(0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0);
  const normals = smoothNormals(positions, Uint32Array.of(0, 2, 1, 3, 5, 4));
  const half = Math.SQRT1_2;
  [0, half, half].forEach((value, c) => near(normals[c]!, value));
  assert.deepEqual(normals.slice(0, 3), normals.slice(9, 12));
});
