import { Box3, Mesh, Vector3, type BufferGeometry, type Object3D } from "three";
import type { Colour } from "./emission.ts";

// What a file gives: triangles in metres, and how they emit.
export interface DroppedMesh {
  name: string;
  positions: Uint8Array; // float32 x, y, z
  indices: Uint8Array; // uint32
  uvs?: Uint8Array; // float32 u, v
  texture?: { width: number; height: number; texels: Uint8Array }; // 3 bytes a texel, sRGB-coded
  radiance: Colour;
  twoSided: boolean;
  min: Colour;
  max: Colour;
}

// A picture of all that is far away.
export interface DroppedSky {
  name: string;
  sky: { width: number; height: number; texels: Uint8Array }; // 3 half floats a texel, linear
}

export type DroppedLight = DroppedMesh | DroppedSky;

const PICTURE = /\.(png|jpe?g|webp|gif|bmp|avif)$/i;
const SKY = /\.(hdr|exr)$/i;
const PICTURE_WIDTH = 1.6; // metres, of a picture as a television
const MOST_TEXELS_ALONG = 4096;
const PLAIN: Colour = { x: 5, y: 5, z: 5 };

// Lights of the files that people drop or choose: a picture becomes a television, one with a high range (HDR, EXR) the sky,
// a mesh a light. Files that others name
// (buffers of glTF) are looked for among the dropped ones only.
export async function readDropped(files: readonly File[]): Promise<DroppedLight[]> {
  const lights: DroppedLight[] = [];
  for (const file of files) {
    const name = file.name.replace(/\.[^.]*$/, "") || "light";
    if (SKY.test(file.name)) lights.push(await sky(file, name));
    else if (PICTURE.test(file.name) || file.type.startsWith("image/")) lights.push(await television(file, name));
    else if (/\.ply$/i.test(file.name)) lights.push(...(await fromPly(file, name)));
    else if (/\.obj$/i.test(file.name)) lights.push(...(await fromObj(file, name)));
    else if (/\.(glb|gltf)$/i.test(file.name)) lights.push(...(await fromGltf(file, files)));
    else if (!/\.bin$/i.test(file.name)) throw new Error(`${file.name}: what can be dropped is GLB, glTF with its .bin, OBJ, PLY, pictures, and HDR or EXR for the sky.`);
  }
  if (lights.length === 0) throw new Error("There are no triangles in what was dropped.");
  return lights;
}

// The loader takes 255 for 1 where Radiance, and lpvctl, take 256.
const OF_RADIANCE = 255 / 256;
// three.js cuts halves off instead of rounding: this much more leaves those that are exact as they are.
const TO_HALF = 1 + 2 ** -14;
const LARGEST_HALF = 65504;

// Linear, equirectangular; texels that are negative or not finite become 0, as lpvctl has them.
async function sky(file: File, name: string): Promise<DroppedSky> {
  const bytes = await file.arrayBuffer();
  const { DataUtils, FloatType } = await import("three");
  const isExr = /\.exr$/i.test(file.name);
  const read = async () => {
    if (!isExr) return new (await import("three/examples/jsm/loaders/HDRLoader.js")).HDRLoader().setDataType(FloatType).parse(bytes);
    return new (await import("three/examples/jsm/loaders/EXRLoader.js")).EXRLoader().setDataType(FloatType).parse(bytes);
  };
  const { width, height, data } = await read().catch(() => {
    throw new Error(`${file.name}: this is no picture that the page can read.`);
  });
  if (!width || !height || !data) throw new Error(`${file.name}: the picture is empty.`);
  const channels = data.length / (width * height);
  const texels = new DataView(new ArrayBuffer(width * height * 6));
  for (let y = 0; y < height; ++y) {
    const row = (isExr ? height - 1 - y : y) * width; // rows of EXR begin at the bottom
    for (let x = 0; x < width; ++x) {
      for (let c = 0; c < 3; ++c) {
        const value = Number(data[(row + x) * channels + Math.min(c, channels - 1)]) * (isExr ? 1 : OF_RADIANCE);
        const kept = Number.isFinite(value) && value > 0 ? Math.min(value * TO_HALF, LARGEST_HALF) : 0;
        texels.setUint16(6 * (y * width + x) + 2 * c, DataUtils.toHalfFloat(kept), true);
      }
    }
  }
  return { name, sky: { width, height, texels: new Uint8Array(texels.buffer) } };
}

async function television(file: File, name: string): Promise<DroppedMesh> {
  const whole = await createImageBitmap(file, { colorSpaceConversion: "none", premultiplyAlpha: "none" }).catch(() => {
    throw new Error(`${file.name}: this browser cannot read the picture.`);
  });
  const smaller = Math.min(1, MOST_TEXELS_ALONG / Math.max(whole.width, whole.height));
  const width = Math.max(1, Math.round(whole.width * smaller));
  const height = Math.max(1, Math.round(whole.height * smaller));
  const context = new OffscreenCanvas(width, height).getContext("2d", { colorSpace: "srgb" });
  if (!context) throw new Error(`${file.name}: this browser cannot read pictures.`);
  context.drawImage(whole, 0, 0, width, height);
  const { data } = context.getImageData(0, 0, width, height);
  const texels = new Uint8Array(width * height * 3);
  for (let i = 0; i < width * height; ++i) texels.set(data.subarray(4 * i, 4 * i + 3), 3 * i);
  const x = PICTURE_WIDTH / 2;
  const y = (x * height) / width;
  return {
    name, positions: floats([-x, -y, 0, x, -y, 0, x, y, 0, -x, y, 0]), indices: numbers([0, 1, 2, 0, 2, 3]),
    uvs: floats([0, 1, 1, 1, 1, 0, 0, 0]), texture: { width, height, texels }, radiance: PLAIN, twoSided: false,
    min: { x: -x, y: -y, z: 0 }, max: { x, y, z: 0 },
  };
}

async function fromPly(file: File, name: string): Promise<DroppedMesh[]> {
  const { PLYLoader } = await import("three/examples/jsm/loaders/PLYLoader.js");
  return [lightOf(new PLYLoader().parse(await file.arrayBuffer()), name)];
}

async function fromObj(file: File, name: string): Promise<DroppedMesh[]> {
  const { OBJLoader } = await import("three/examples/jsm/loaders/OBJLoader.js");
  return lightsOf(new OBJLoader().parse(await file.text()), name);
}

interface Gltf {
  buffers?: { uri?: string; byteLength: number }[];
  bufferViews?: { buffer: number; byteOffset?: number }[];
  materials?: Material[];
  images?: unknown;
  textures?: unknown;
  samplers?: unknown;
}
interface Material {
  name?: string;
  doubleSided?: boolean;
  emissiveFactor?: number[];
  extensions?: { KHR_materials_emissive_strength?: { emissiveStrength?: number } };
}

const GLB = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const BIN_CHUNK = 0x004e4942;

// The loader is given one GLB without pictures, so that it has nothing to fetch.
async function fromGltf(file: File, among: readonly File[]): Promise<DroppedMesh[]> {
  const { GLTFLoader } = await import("three/examples/jsm/loaders/GLTFLoader.js");
  const bytes = await file.arrayBuffer();
  const isGlb = bytes.byteLength >= 20 && new DataView(bytes).getUint32(0, true) === GLB;
  const { json, chunk } = isGlb ? chunksOf(bytes) : { json: JSON.parse(new TextDecoder().decode(bytes)) as Gltf, chunk: new Uint8Array() };
  const buffers: Uint8Array[] = [];
  for (const { uri } of json.buffers ?? []) buffers.push(uri === undefined ? chunk : await resolved(uri, file, among));
  const materials = json.materials ?? [];
  const plain = { ...json, ...joined(json, buffers), materials: materials.map(({ name, doubleSided }) => ({ name, doubleSided })) };
  delete plain.images;
  delete plain.textures;
  delete plain.samplers;
  const { scene, parser } = await new GLTFLoader().parseAsync(glbOf(plain, buffers), "");
  return lightsOf(scene, file.name.replace(/\.[^.]*$/, ""), (mesh) => {
    const index = parser.associations.get(Array.isArray(mesh.material) ? mesh.material[0] as never : mesh.material)?.materials;
    return index === undefined ? undefined : materials[index];
  });
}

async function resolved(uri: string, file: File, among: readonly File[]): Promise<Uint8Array> {
  const inline = /^data:[^,]*;base64,/.exec(uri);
  if (inline) return Uint8Array.from(atob(uri.slice(inline[0].length)), (letter) => letter.charCodeAt(0));
  const name = decodeURIComponent(uri).split("/").pop() ?? "";
  const found = among.find((one) => one.name === name);
  if (!found) throw new Error(`${file.name} needs ${name}: drop both together.`);
  return new Uint8Array(await found.arrayBuffer());
}

function chunksOf(bytes: ArrayBuffer): { json: Gltf; chunk: Uint8Array } {
  const view = new DataView(bytes);
  let json: Gltf = {};
  let chunk = new Uint8Array();
  for (let at = 12; at + 8 <= bytes.byteLength; ) {
    const length = view.getUint32(at, true);
    const kind = view.getUint32(at + 4, true);
    const content = new Uint8Array(bytes, at + 8, Math.min(length, bytes.byteLength - at - 8));
    if (kind === JSON_CHUNK) json = JSON.parse(new TextDecoder().decode(content)) as Gltf;
    if (kind === BIN_CHUNK) chunk = content;
    at += 8 + length;
  }
  return { json, chunk };
}

const padded = (bytes: number): number => (bytes + 3) & ~3;

// All buffers as one, one behind the other.
function joined(json: Gltf, buffers: readonly Uint8Array[]): Pick<Gltf, "buffers" | "bufferViews"> {
  const starts: number[] = [];
  let length = 0;
  for (const buffer of buffers) {
    starts.push(length);
    length += padded(buffer.length);
  }
  return {
    buffers: [{ byteLength: length }],
    bufferViews: (json.bufferViews ?? []).map((one) => ({ ...one, buffer: 0, byteOffset: (one.byteOffset ?? 0) + (starts[one.buffer] ?? 0) })),
  };
}

function glbOf(json: Gltf, buffers: readonly Uint8Array[]): ArrayBuffer {
  const text = new TextEncoder().encode(JSON.stringify(json));
  const textLength = padded(text.length);
  const binLength = buffers.reduce((sum, one) => sum + padded(one.length), 0);
  const out = new Uint8Array(12 + 8 + textLength + 8 + binLength);
  const view = new DataView(out.buffer);
  [GLB, 2, out.length, textLength, JSON_CHUNK].forEach((value, i) => view.setUint32(4 * i, value, true));
  out.fill(0x20, 20, 20 + textLength);
  out.set(text, 20);
  view.setUint32(20 + textLength, binLength, true);
  view.setUint32(24 + textLength, BIN_CHUNK, true);
  let at = 28 + textLength;
  for (const buffer of buffers) {
    out.set(buffer, at);
    at += padded(buffer.length);
  }
  return out.buffer;
}

function lightsOf(root: Object3D, name: string, materialOf: (mesh: Mesh) => Material | undefined = () => undefined): DroppedMesh[] {
  const lights: DroppedMesh[] = [];
  root.updateMatrixWorld(true);
  root.traverse((one) => {
    if (!(one instanceof Mesh)) return;
    const geometry = (one.geometry as BufferGeometry).clone().applyMatrix4(one.matrixWorld);
    const material = materialOf(one);
    const strength = material?.extensions?.KHR_materials_emissive_strength?.emissiveStrength ?? 1;
    const [r = 0, g = 0, b = 0] = (material?.emissiveFactor ?? []).map((value) => value * strength);
    const light = lightOf(geometry, one.name || name);
    if (r + g + b > 0) light.radiance = { x: r, y: g, z: b };
    light.twoSided = material?.doubleSided ?? false;
    lights.push(light);
  });
  return lights;
}

function lightOf(geometry: BufferGeometry, name: string): DroppedMesh {
  const position = geometry.getAttribute("position");
  if (!position || position.count < 3) throw new Error(`${name}: there are no triangles in it.`);
  const at = new Vector3();
  const values = new Float32Array(3 * position.count);
  for (let i = 0; i < position.count; ++i) at.fromBufferAttribute(position, i).toArray(values, 3 * i);
  const { index } = geometry;
  const indices = new Uint32Array(index ? index.count : position.count - (position.count % 3));
  for (let i = 0; i < indices.length; ++i) indices[i] = index ? index.getX(i) : i;
  const { min, max } = new Box3().setFromArray(values);
  return {
    name, positions: new Uint8Array(values.buffer), indices: new Uint8Array(indices.buffer), radiance: PLAIN, twoSided: false,
    min: { x: min.x, y: min.y, z: min.z }, max: { x: max.x, y: max.y, z: max.z },
  };
}

const floats = (values: number[]): Uint8Array => new Uint8Array(new Float32Array(values).buffer);
const numbers = (values: number[]): Uint8Array => new Uint8Array(new Uint32Array(values).buffer);
