// What the page reads of glTF 2.0, as its JSON has it. Nothing in it is sure to be there.
export interface Gltf {
  asset?: { version?: string };
  scene?: number;
  scenes?: { nodes?: number[] }[];
  nodes?: Node[];
  meshes?: { name?: string; primitives?: Primitive[] }[];
  cameras?: { perspective?: { yfov?: number; znear?: number; zfar?: number } }[];
  accessors?: Accessor[];
  bufferViews?: BufferView[];
  buffers?: { uri?: string; byteLength?: number }[];
  materials?: GltfMaterial[];
  textures?: { source?: number; extensions?: { EXT_texture_webp?: { source?: number } } }[];
  images?: { uri?: string; bufferView?: number }[];
  extensionsRequired?: string[];
}

export interface Node {
  name?: string;
  mesh?: number;
  camera?: number;
  children?: number[];
  matrix?: number[];
  translation?: number[];
  rotation?: number[];
  scale?: number[];
}

export interface Primitive {
  attributes?: Record<string, number>;
  indices?: number;
  material?: number;
  mode?: number;
  extensions?: { KHR_draco_mesh_compression?: { bufferView: number; attributes?: Record<string, number> } };
}

export interface Accessor {
  bufferView?: number;
  byteOffset?: number;
  componentType?: number;
  normalized?: boolean;
  count?: number;
  type?: string;
  sparse?: { count: number; indices: { bufferView: number; byteOffset?: number; componentType: number }; values: { bufferView: number; byteOffset?: number } };
}

export interface Slice {
  buffer?: number;
  byteOffset?: number;
  byteLength?: number;
  byteStride?: number;
}

export interface BufferView extends Slice {
  extensions?: { EXT_meshopt_compression?: Slice & { count?: number; mode?: string; filter?: string } };
}

export interface TextureOf {
  index?: number;
  texCoord?: number;
  scale?: number;
  extensions?: { KHR_texture_transform?: unknown };
}

export interface GltfMaterial {
  name?: string;
  doubleSided?: boolean;
  alphaMode?: string;
  alphaCutoff?: number;
  emissiveFactor?: number[];
  emissiveTexture?: TextureOf;
  normalTexture?: TextureOf;
  pbrMetallicRoughness?: {
    baseColorFactor?: number[];
    baseColorTexture?: TextureOf;
    metallicFactor?: number;
    roughnessFactor?: number;
    metallicRoughnessTexture?: TextureOf;
  };
  extensions?: {
    KHR_materials_emissive_strength?: { emissiveStrength?: number };
    KHR_materials_transmission?: { transmissionFactor?: number; transmissionTexture?: TextureOf };
    KHR_materials_pbrSpecularGlossiness?: { diffuseTexture?: TextureOf };
  };
}

// Those that change nothing of what is read here, and those that are read.
const KNOWN = new Set([
  "KHR_mesh_quantization", "KHR_draco_mesh_compression", "EXT_meshopt_compression", "EXT_texture_webp", "KHR_lights_punctual", "KHR_materials_anisotropy", "KHR_materials_clearcoat",
  "KHR_materials_dispersion", "KHR_materials_emissive_strength", "KHR_materials_ior", "KHR_materials_iridescence",
  "KHR_materials_pbrSpecularGlossiness", "KHR_materials_sheen", "KHR_materials_specular", "KHR_materials_transmission",
  "KHR_materials_unlit", "KHR_materials_variants", "KHR_materials_volume", "KHR_texture_transform", "KHR_xmp_json_ld",
]);

const GLB = 0x46546c67;
const JSON_CHUNK = 0x4e4f534a;
const BIN_CHUNK = 0x004e4942;

// The JSON of a file, and the buffer that a GLB has behind it. `name` is the file's, for messages.
export function openGltf(bytes: ArrayBuffer, name: string): { json: Gltf; chunk: Uint8Array } {
  const isGlb = bytes.byteLength >= 20 && new DataView(bytes).getUint32(0, true) === GLB;
  const { text, chunk } = isGlb ? chunksOf(bytes, name) : { text: new Uint8Array(bytes), chunk: new Uint8Array() };
  let json: Gltf;
  try {
    json = JSON.parse(new TextDecoder().decode(text)) as Gltf;
  } catch {
    throw new Error(`${name} is not glTF: its JSON cannot be read. Export it again.`);
  }
  const version = String(json.asset?.version ?? "");
  if (!version.startsWith("2.")) throw new Error(`${name} is glTF of version ${version || "unknown"}: the page reads version 2. Convert it.`);
  for (const extension of json.extensionsRequired ?? []) {
    if (!KNOWN.has(extension)) throw new Error(`${name} requires ${extension}, which the page does not read. Export it without.`);
  }
  return { json, chunk };
}

function chunksOf(bytes: ArrayBuffer, name: string): { text: Uint8Array; chunk: Uint8Array } {
  const view = new DataView(bytes);
  const announced = view.getUint32(8, true);
  if (announced > bytes.byteLength) throw new Error(`${name} is cut short: it has ${bytes.byteLength} of ${announced} bytes. Copy it again.`);
  let text = new Uint8Array();
  let chunk = new Uint8Array();
  for (let at = 12; at + 8 <= bytes.byteLength; ) {
    const length = view.getUint32(at, true);
    const kind = view.getUint32(at + 4, true);
    const content = new Uint8Array(bytes, at + 8, Math.min(length, bytes.byteLength - at - 8));
    if (kind === JSON_CHUNK) text = content;
    if (kind === BIN_CHUNK) chunk = content;
    at += 8 + length;
  }
  return { text, chunk };
}
