// Small files of lights, written byte by byte.
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { deflateSync } from "node:zlib";

const CORNERS = [[-0.2, -0.1, 0], [0.2, -0.1, 0], [0.2, 0.1, 0], [-0.2, 0.1, 0]];
const TRIANGLES = [[0, 1, 2], [0, 2, 3]];

export function obj(folder) {
  const file = join(folder, "panel.obj");
  writeFileSync(file, [...CORNERS.map((v) => `v ${v.join(" ")}`), "f 1 2 3 4", ""].join("\n"));
  return file;
}

export function ply(folder) {
  const file = join(folder, "plate.ply");
  writeFileSync(file, ["ply", "format ascii 1.0", "element vertex 4", "property float x", "property float y", "property float z",
    "element face 2", "property list uchar int vertex_indices", "end_header", ...CORNERS.map((v) => v.map((x) => 2 * x).join(" ")),
    ...TRIANGLES.map((t) => `3 ${t.join(" ")}`), ""].join("\n"));
  return file;
}

// Twice as large by its node, with an emission of 6, 3, 1.5 and a buffer in a file of its own.
export function gltf(folder) {
  const positions = new Float32Array(CORNERS.flat());
  const indices = new Uint16Array(TRIANGLES.flat());
  const buffer = Buffer.concat([Buffer.from(positions.buffer), Buffer.from(indices.buffer)]);
  const json = {
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0, name: "tile", scale: [2, 2, 2] }],
    meshes: [{ primitives: [{ attributes: { POSITION: 0 }, indices: 1, material: 0 }] }],
    materials: [{ emissiveFactor: [1, 0.5, 0.25], extensions: { KHR_materials_emissive_strength: { emissiveStrength: 6 } } }],
    extensionsUsed: ["KHR_materials_emissive_strength"],
    buffers: [{ uri: "tile.bin", byteLength: buffer.length }],
    bufferViews: [{ buffer: 0, byteLength: 48 }, { buffer: 0, byteOffset: 48, byteLength: 12 }],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 4, type: "VEC3", min: [-0.2, -0.1, 0], max: [0.2, 0.1, 0] },
      { bufferView: 1, componentType: 5123, count: 6, type: "SCALAR" },
    ],
  };
  const files = [join(folder, "tile.gltf"), join(folder, "tile.bin")];
  writeFileSync(files[0], JSON.stringify(json));
  writeFileSync(files[1], buffer);
  return files;
}

function crc(bytes) {
  let value = 0xffffffff;
  for (const byte of bytes) {
    value ^= byte;
    for (let i = 0; i < 8; ++i) value = value & 1 ? (value >>> 1) ^ 0xedb88320 : value >>> 1;
  }
  return (value ^ 0xffffffff) >>> 0;
}

// 4 x 2 texels, of which the first is red.
export function png(folder) {
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type), data]);
    const ends = [Buffer.alloc(4), Buffer.alloc(4)];
    ends[0].writeUInt32BE(data.length);
    ends[1].writeUInt32BE(crc(body));
    return Buffer.concat([ends[0], body, ends[1]]);
  };
  const head = Buffer.alloc(13);
  head.writeUInt32BE(4, 0);
  head.writeUInt32BE(2, 4);
  head.set([8, 2, 0, 0, 0], 8);
  const rows = Buffer.concat([0, 1].map((y) => Buffer.from([0, ...[0, 1, 2, 3].flatMap((x) => (x + y === 0 ? [255, 0, 0] : [10, 20, 30]))])));
  const file = join(folder, "screen.png");
  writeFileSync(file, Buffer.concat([Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), chunk("IHDR", head), chunk("IDAT", deflateSync(rows)), chunk("IEND", Buffer.alloc(0))]));
  return file;
}

// A sky of 8 x 4 texels: blue, a bright one, and one that is black.
export function hdr(folder) {
  const texels = [];
  for (let i = 0; i < 32; ++i) texels.push(...(i === 9 ? [200, 180, 150, 138] : i === 20 ? [0, 0, 0, 0] : [40 + i, 90, 200, 129]));
  const file = join(folder, "evening.hdr");
  writeFileSync(file, Buffer.concat([Buffer.from("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n"), Buffer.from(texels)]));
  return file;
}
