import assert from "node:assert/strict";
import { test } from "node:test";
import { MeshoptEncoder } from "meshoptimizer/encoder";
import { MeshoptDecoder } from "meshoptimizer/decoder";
import { decodeMeshopt } from "../src/scene/files/meshopt.ts";

// Numbers that are the same every time.
function random(seed: number): () => number {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

const packed = (source: Uint8Array, count: number, stride: number, mode: string): Uint8Array => MeshoptEncoder.encodeGltfBuffer(source, count, stride, mode, 0);

test("attributes that meshoptimizer packed come back byte by byte", async () => {
  await MeshoptEncoder.ready;
  const number = random(7);
  for (const [count, stride] of [[1, 4], [16, 8], [17, 12], [255, 16], [1000, 20], [3000, 64], [700, 256]] as const) {
    for (const noise of [0, 3, 20, 256]) {
      const source = Uint8Array.from({ length: count * stride }, (_, i) => Math.floor(i / stride) * (i % 3) + noise * number());
      const bytes = packed(source, count, stride, "ATTRIBUTES");
      assert.deepEqual(decodeMeshopt({ bytes, count, stride, mode: "ATTRIBUTES", filter: "NONE" }), source, `${count} of ${stride}, noise ${noise}`);
    }
  }
});

test("triangles and indices that meshoptimizer packed come back as its own decoder has them", async () => {
  await Promise.all([MeshoptEncoder.ready, MeshoptDecoder.ready]);
  const number = random(11);
  for (const width of [1, 5, 40]) {
    const grid: number[] = [];
    for (let y = 0; y < width; ++y) {
      for (let x = 0; x < width; ++x) {
        const at = y * (width + 1) + x;
        grid.push(at, at + 1, at + width + 1, at + 1, at + width + 2, at + width + 1);
        if (number() < 0.3) grid.push(...[0, 0, 0].map(() => Math.floor(number() * (width + 1) ** 2)));
      }
    }
    for (const stride of [2, 4]) {
      const source = new Uint8Array((stride === 2 ? Uint16Array.from(grid) : Uint32Array.from(grid)).buffer);
      for (const mode of ["TRIANGLES", "INDICES"]) {
        const bytes = packed(source, grid.length, stride, mode);
        const wanted = new Uint8Array(source.length);
        MeshoptDecoder.decodeGltfBuffer(wanted, grid.length, stride, bytes, mode);
        assert.deepEqual(decodeMeshopt({ bytes, count: grid.length, stride, mode, filter: "NONE" }), wanted, `${mode} of ${stride} bytes, ${width} wide`);
      }
    }
  }
});

test("filters give what meshoptimizer's own decoder gives", async () => {
  await Promise.all([MeshoptEncoder.ready, MeshoptDecoder.ready]);
  const number = random(13);
  const count = 200;
  const unit = (): number[] => {
    const v = [0, 0, 0, 0].map(() => 2 * number() - 1);
    return v.map((value) => value / Math.hypot(...v));
  };
  const vectors = Float32Array.from(Array.from({ length: count }, unit).flat());
  const directions = vectors.map((value, i) => (i % 4 === 3 ? 0 : value / Math.hypot(vectors[i - (i % 4)]!, vectors[i - (i % 4) + 1]!, vectors[i - (i % 4) + 2]!)));
  const cases: [string, number, Uint8Array][] = [
    ["OCTAHEDRAL", 4, MeshoptEncoder.encodeFilterOct(directions, count, 4, 8)],
    ["OCTAHEDRAL", 8, MeshoptEncoder.encodeFilterOct(directions, count, 8, 12)],
    ["QUATERNION", 8, MeshoptEncoder.encodeFilterQuat(vectors, count, 8, 12)],
    ["EXPONENTIAL", 16, MeshoptEncoder.encodeFilterExp(vectors, count, 16, 15)],
  ];
  for (const [filter, stride, source] of cases) {
    const bytes = packed(source, count, stride, "ATTRIBUTES");
    const wanted = new Uint8Array(source.length);
    MeshoptDecoder.decodeGltfBuffer(wanted, count, stride, bytes, "ATTRIBUTES", filter);
    const unpacked = decodeMeshopt({ bytes, count, stride, mode: "ATTRIBUTES", filter });
    if (filter !== "QUATERNION") assert.deepEqual(unpacked, wanted, `${filter} of ${stride} bytes`);
    const values = new Int16Array(unpacked.buffer);
    new Int16Array(wanted.buffer).forEach((value, i) => assert.ok(Math.abs(values[i]! - value) <= 1, `${filter}: ${values[i]} is not ${value}`));
  }
});

test("damaged bytes are refused in words", async () => {
  await MeshoptEncoder.ready;
  const source = Uint8Array.from({ length: 400 }, (_, i) => i);
  const bytes = packed(source, 100, 4, "ATTRIBUTES");
  const given = { count: 100, stride: 4, mode: "ATTRIBUTES", filter: "NONE" };
  assert.throws(() => decodeMeshopt({ ...given, bytes: bytes.subarray(0, 40) }), /is damaged/);
  assert.throws(() => decodeMeshopt({ ...given, bytes: Uint8Array.from(bytes, (byte, i) => (i === 0 ? 0xb0 : byte)) }), /is damaged/);
  assert.throws(() => decodeMeshopt({ ...given, bytes: Uint8Array.from([...bytes, 0]) }), /is damaged/, "a byte more than there should be");
  assert.throws(() => decodeMeshopt({ ...given, bytes, stride: 6 }), /does not allow together/);
});
