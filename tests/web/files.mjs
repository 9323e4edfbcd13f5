// Small files of lights, written byte by byte.
import { readFileSync, writeFileSync } from "node:fs";
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

// A pentagon with a dent, its faces before its vertices, and texture coordinates.
export function pentagonPly(folder) {
  const file = join(folder, "pentagon.ply");
  writeFileSync(file, ["ply", "format ascii 1.0", "element face 1", "property list uchar int vertex_indices", "element vertex 5",
    ...["x", "y", "z", "s", "t"].map((name) => `property float ${name}`), "end_header", "5 0 1 2 3 4",
    "0 0 0 0 0", "2 0 0 1 0", "2 2 0 1 1", "1 .5 0 .5 .2", "0 2 0 0 1", ""].join("\n"));
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

// A PNG of 8 bits: 3 or 4 numbers a texel.
function pngOf(width, height, texel) {
  const chunk = (type, data) => {
    const body = Buffer.concat([Buffer.from(type), data]);
    const ends = [Buffer.alloc(4), Buffer.alloc(4)];
    ends[0].writeUInt32BE(data.length);
    ends[1].writeUInt32BE(crc(body));
    return Buffer.concat([ends[0], body, ends[1]]);
  };
  const row = (y) => [0, ...Array.from({ length: width }, (_, x) => texel(x, y)).flat()];
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, texel(0, 0).length === 4 ? 6 : 2, 0, 0, 0], 8);
  const rows = Buffer.from(Array.from({ length: height }, (_, y) => row(y)).flat());
  return Buffer.concat([Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), chunk("IHDR", head), chunk("IDAT", deflateSync(rows)), chunk("IEND", Buffer.alloc(0))]);
}

// 4 x 2 texels, of which the first is red.
export function png(folder) {
  const file = join(folder, "screen.png");
  writeFileSync(file, pngOf(4, 2, (x, y) => (x + y === 0 ? [255, 0, 0] : [10, 20, 30])));
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

// Every number of these differs from its neighbours', so that a picture upside down or mirrored shows.
const screenPicture = () => pngOf(4, 3, (x, y) => [60 * x + 10, 100 * y + 20, 200 - 40 * x]);
const leafPicture = () => pngOf(3, 2, (x, y) => [80 * x + 30, 120 * y + 40, 25, x === 1 ? (y === 0 ? 0 : 90) : 255]);
const numbersPicture = () => pngOf(2, 2, (x, y) => [128 + 20 * x, 128 - 30 * y, 250 - 10 * x]);
const SQUARE_UVS = [[0, 1], [0.75, 1], [0.75, 0], [0, 0]];

const aligned = (bytes) => Buffer.concat([bytes, Buffer.alloc((4 - (bytes.length % 4)) % 4)]);

function glbOf(json, chunks) {
  const bufferViews = [];
  let at = 0;
  for (const chunk of chunks) {
    bufferViews.push({ buffer: 0, byteOffset: at, byteLength: chunk.length });
    at += aligned(chunk).length;
  }
  const text = aligned(Buffer.from(JSON.stringify({ ...json, bufferViews, buffers: [{ byteLength: at }] }))).map((byte) => byte || 0x20);
  const header = (...numbers) => Buffer.from(new Uint32Array(numbers).buffer);
  return Buffer.concat([header(0x46546c67, 2, 28 + text.length + at, text.length, 0x4e4f534a), text, header(at, 0x004e4942), ...chunks.map(aligned)]);
}

// A screen that emits its picture, and what it lights: a card of leaves with all pictures that a surface may have, a
// sheared pane of glass, and the card a second time.
export function roomGlb(folder) {
  const floats = (rows) => Buffer.from(new Float32Array(rows.flat()).buffer);
  const texture = (index, more = {}) => ({ index, texCoord: 0, ...more });
  const json = {
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0, 1, 2, 4] }],
    nodes: [
      { name: "screen", mesh: 0, translation: [0, 1, -1], scale: [4, 3, 1] },
      { name: "leaves", mesh: 1, translation: [0.6, 0.7, 0.2], rotation: [0, Math.sin(0.3), 0, Math.cos(0.3)], scale: [2, 2, 2] },
      { name: "tilted", scale: [2, 1, 1], children: [3] },
      { name: "pane", mesh: 2, translation: [-0.3, 0.6, 0.3], rotation: [0, 0, Math.sin(0.4), Math.cos(0.4)] },
      { name: "leaves", mesh: 1, translation: [-0.7, 1.4, 0.1], scale: [-2, 2, 2] },
    ],
    meshes: [0, 1, 2].map((material) => ({ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1, NORMAL: 2 }, indices: 3, material }] })),
    materials: [
      { name: "glow", emissiveFactor: [1, 0.5, 0.25], emissiveTexture: texture(0), extensions: { KHR_materials_emissive_strength: { emissiveStrength: 8 } } },
      { name: "leaf", alphaMode: "MASK", alphaCutoff: 0.3, doubleSided: true, normalTexture: texture(2, { scale: 0.7 }),
        pbrMetallicRoughness: { baseColorFactor: [0.9, 0.8, 0.7, 1], baseColorTexture: texture(1), metallicFactor: 0.25, roughnessFactor: 0.75, metallicRoughnessTexture: texture(2) } },
      { name: "glass", extensions: { KHR_materials_transmission: { transmissionFactor: 0.75 } },
        pbrMetallicRoughness: { baseColorFactor: [0.5, 0.75, 1, 1], baseColorTexture: texture(0), metallicFactor: 0 } },
    ],
    textures: [{ source: 0 }, { source: 1 }, { source: 2 }],
    images: [4, 5, 6].map((bufferView) => ({ bufferView, mimeType: "image/png" })),
    extensionsUsed: ["KHR_materials_emissive_strength", "KHR_materials_transmission"],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 4, type: "VEC3", min: [-0.2, -0.1, 0], max: [0.2, 0.1, 0] },
      { bufferView: 1, componentType: 5126, count: 4, type: "VEC2" },
      { bufferView: 2, componentType: 5126, count: 4, type: "VEC3" },
      { bufferView: 3, componentType: 5123, count: 6, type: "SCALAR" },
    ],
  };
  const indices = Buffer.from(new Uint16Array(TRIANGLES.flat()).buffer);
  const file = join(folder, "room.glb");
  writeFileSync(file, glbOf(json, [floats(CORNERS), floats(SQUARE_UVS), floats(CORNERS.map(() => [0, 0, 1])), indices, screenPicture(), leafPicture(), numbersPicture()]));
  return [file];
}

// A lamp with its picture, a wall with another, a pane, and a face whose material is nowhere.
export function roomObj(folder) {
  const at = (x, z) => CORNERS.map((v) => `v ${5 * v[0] + x} ${5 * v[1] + 1} ${z}`);
  const face = (first) => `f ${[0, 1, 2, 3].map((i) => `${first + i}/${i + 1}/1`).join(" ")}`;
  const obj = ["mtllib scene.mtl", ...at(0, -1), ...at(0.4, 0), ...at(-0.4, 0.2), ...at(1, 0.4), ...SQUARE_UVS.map(([u, v]) => `vt ${u} ${1 - v}`), "vn 0 0 1",
    "o lamp", "usemtl glow", face(1), "g wall", "usemtl paint", face(5), "usemtl glass", face(9), "g lost", "usemtl nowhere", face(13), ""];
  const mtl = ["newmtl glow", "Ke 4 3 2", "map_Ke screen%20shot.png", "", "newmtl paint", "Kd 0.5 0.6 0.7", "Pr 0.4", "map_Kd -clamp on leaf.png", "",
    "newmtl glass", "Kd 0.1 0.2 0.3", "d 0.25", "Tf 0.9 0.8 0.7", ""];
  const written = { "scene.obj": obj.join("\n"), "scene.mtl": mtl.join("\r\n"), "screen shot.png": screenPicture(), "leaf.png": leafPicture() };
  return Object.entries(written).map(([name, content]) => {
    writeFileSync(join(folder, name), content);
    return join(folder, name);
  });
}

// A lamp and a floor whose positions are 16 bits and whose texture coordinates 8, in the middle of other bytes.
export function quantizedGltf(folder) {
  const vertices = Buffer.alloc(4 * 12);
  CORNERS.forEach(([x, y], i) => {
    vertices.writeInt16LE(Math.round(x * 5 * 32767), 12 * i);
    vertices.writeInt16LE(Math.round(y * 5 * 32767), 12 * i + 2);
    vertices.writeInt16LE(0, 12 * i + 4);
    vertices.set(SQUARE_UVS[i].map((value) => Math.round(255 * value)), 12 * i + 8);
  });
  const buffer = Buffer.concat([vertices, Buffer.from(TRIANGLES.flat())]);
  const mesh = (material) => ({ primitives: [{ attributes: { POSITION: 0, TEXCOORD_0: 1 }, indices: 2, material }] });
  const json = {
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0, 1] }],
    nodes: [{ mesh: 0, name: "lamp", scale: [0.2, 0.4, 1] }, { mesh: 1, name: "floor", translation: [0, -1, 0], rotation: [-Math.SQRT1_2, 0, 0, Math.SQRT1_2] }],
    meshes: [mesh(0), mesh(1)],
    materials: [{ emissiveFactor: [1, 1, 0.5], doubleSided: true }, { pbrMetallicRoughness: { baseColorTexture: { index: 0 }, roughnessFactor: 0.5 } }],
    textures: [{ source: 0 }], images: [{ uri: `data:image/png;base64,${screenPicture().toString("base64")}` }],
    extensionsUsed: ["KHR_mesh_quantization"], extensionsRequired: ["KHR_mesh_quantization"],
    buffers: [{ uri: "quantized.bin", byteLength: buffer.length }],
    bufferViews: [{ buffer: 0, byteLength: 48, byteStride: 12 }, { buffer: 0, byteOffset: 48, byteLength: 6 }],
    accessors: [
      { bufferView: 0, componentType: 5122, normalized: true, count: 4, type: "VEC3", min: [-32767, -16384, 0], max: [32767, 16384, 0] },
      { bufferView: 0, byteOffset: 8, componentType: 5121, normalized: true, count: 4, type: "VEC2" },
      { bufferView: 1, componentType: 5121, count: 6, type: "SCALAR" },
    ],
  };
  const files = [join(folder, "quantized.gltf"), join(folder, "quantized.bin")];
  writeFileSync(files[0], JSON.stringify(json));
  writeFileSync(files[1], buffer);
  return files;
}

// A lamp and more surfaces than one edit may have, all of one mesh.
export function manyGlb(folder, count) {
  const nodes = Array.from({ length: count }, (_, i) => ({ name: `tile ${i}`, mesh: 1, translation: [(i % 50) * 0.1, 0, Math.floor(i / 50) * 0.1] }));
  const json = {
    asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [...nodes.keys(), count] }], nodes: [...nodes, { name: "lamp", mesh: 0, translation: [2, 2, 2] }],
    meshes: [0, 1].map((material) => ({ primitives: [{ attributes: { POSITION: 0 }, indices: 1, material }] })),
    materials: [{ emissiveFactor: [1, 1, 1] }, {}],
    accessors: [
      { bufferView: 0, componentType: 5126, count: 4, type: "VEC3", min: [-0.2, -0.1, 0], max: [0.2, 0.1, 0] },
      { bufferView: 1, componentType: 5123, count: 6, type: "SCALAR" },
    ],
  };
  const file = join(folder, "many.glb");
  writeFileSync(file, glbOf(json, [Buffer.from(new Float32Array(CORNERS.flat()).buffer), Buffer.from(new Uint16Array(TRIANGLES.flat()).buffer)]));
  return file;
}

// A square of 1 m, as gltf-transform packed it for tests/rpc/cli, that emits.
const square = {
  asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0] }], materials: [{ emissiveFactor: [1, 1, 0.5] }],
};

export function dracoGlb(folder) {
  const packed = Buffer.from("445241434f02020101000000040200020000011fff011101ff0000010009030000020101010003030130011003002882980000000000ff3f"
    + "00000000000000000000000000000000803f0e00", "hex");
  const extensions = { KHR_draco_mesh_compression: { bufferView: 0, attributes: { POSITION: 0 } } };
  const used = ["KHR_draco_mesh_compression"];
  const file = join(folder, "draco.glb");
  writeFileSync(file, glbOf({
    ...square, extensionsUsed: used, extensionsRequired: used, nodes: [{ name: "square", mesh: 0 }],
    meshes: [{ primitives: [{ attributes: { POSITION: 1 }, indices: 0, material: 0, extensions }] }],
    accessors: [{ type: "SCALAR", componentType: 5123, count: 6 }, { type: "VEC3", componentType: 5126, count: 4, min: [0, 0, 0], max: [1, 1, 0] }],
  }, [packed]));
  return file;
}

// Packed by meshopt, quantised too; what it is unpacked to has a buffer without bytes.
export function meshoptGltf(folder) {
  const packed = Buffer.from("e1f000007687566778a986658968980169000000a0013300000003040112000000010c000000030104000000000000000000000000000000"
    + "000000000000000000000000000000000180018000000000", "hex");
  const of = (byteOffset, byteLength, more) => ({ EXT_meshopt_compression: { buffer: 0, byteOffset, byteLength, ...more } });
  const used = ["EXT_meshopt_compression", "KHR_mesh_quantization"];
  const file = join(folder, "meshopt.gltf");
  writeFileSync(file, JSON.stringify({
    ...square, extensionsUsed: used, extensionsRequired: used, nodes: [{ name: "square", mesh: 0, translation: [0.5, 0.5, 0], scale: [0.5, 0.5, 0.5] }],
    meshes: [{ primitives: [{ attributes: { POSITION: 1 }, indices: 0, material: 0 }] }],
    accessors: [{ type: "SCALAR", componentType: 5123, count: 6, bufferView: 0 }, { type: "VEC3", componentType: 5122, count: 4, normalized: true, bufferView: 1 }],
    buffers: [{ uri: `data:application/octet-stream;base64,${packed.toString("base64")}`, byteLength: packed.length },
      { byteLength: 44, extensions: { EXT_meshopt_compression: { fallback: true } } }],
    bufferViews: [{ buffer: 1, byteLength: 12, extensions: of(0, 19, { mode: "TRIANGLES", byteStride: 2, count: 6 }) },
      { buffer: 1, byteOffset: 12, byteLength: 32, byteStride: 8, extensions: of(20, 60, { mode: "ATTRIBUTES", byteStride: 8, count: 4 }) }],
  }));
  return file;
}

// The packed square with a byte of Draco's head changed.
export function damagedGlb(folder) {
  const bytes = readFileSync(dracoGlb(folder));
  bytes[bytes.indexOf("DRACO")] = 0x58;
  const file = join(folder, "damaged.glb");
  writeFileSync(file, bytes);
  return file;
}
