import { Matrix4, Quaternion, Vector3 } from "three";
import type { DroppedFiles } from "./dropped_files.ts";
import type { Unpacked } from "./draco.ts";
import { GltfData } from "./gltf_data.ts";
import { openGltf, type Gltf, type Node, type Primitive } from "./gltf_json.ts";
import { GltfMaterials } from "./gltf_materials.ts";
import { objectName, stemOf, type FileCamera, type FileContent, type Triangles } from "./parts.ts";
import { Pictures } from "./pictures.ts";
import { placed } from "./place.ts";

const TRIANGLES = 4;
const STRIP = 5;
const FAN = 6;

// A glTF or GLB with its materials: one part per node and primitive, named after the node.
export async function readGltf(file: File, files: DroppedFiles, warnings: string[]): Promise<FileContent> {
  const { json, chunk } = openGltf(await file.arrayBuffer(), file.name);
  const data = await GltfData.open(json, chunk, file, files);
  const materials = new GltfMaterials(json, data, new Pictures(files, file.name, warnings), file.name, warnings);
  const meshes = new GltfMeshes(data, file.name, await unpacked(json, data, file.name));
  const content: FileContent = { parts: [], cameras: [] };
  const stem = stemOf(file.name);
  for (const { node, matrix } of nodesOf(json, file.name)) {
    const mesh = json.meshes?.[node.mesh ?? -1];
    for (const primitive of mesh?.primitives ?? []) {
      const material = await materials.at(primitive.material);
      const triangles = meshes.trianglesOf(primitive, material.uvChannel);
      if (triangles) content.parts.push({ name: objectName(node.name, mesh?.name, stem), material, ...placed(triangles, matrix) });
    }
    const camera = cameraOf(json, node, matrix, stem);
    if (camera) content.cameras.push(camera);
  }
  return content;
}

// The primitives that KHR_draco_mesh_compression has packed. Its decoder is loaded where there is one.
async function unpacked(json: Gltf, data: GltfData, file: string): Promise<ReadonlyMap<Primitive, Unpacked>> {
  const found = new Map<Primitive, Unpacked>();
  for (const primitive of json.meshes?.flatMap(({ primitives = [] }) => primitives) ?? []) {
    const packed = primitive.extensions?.KHR_draco_mesh_compression;
    if (!packed) continue;
    const { decodeDraco } = await import("./draco.ts");
    const isNormalised = (name: string): boolean => data.isNormalised(primitive.attributes?.[name]);
    try {
      found.set(primitive, await decodeDraco(data.view(packed.bufferView), packed.attributes ?? {}, isNormalised));
    } catch (error) {
      throw new Error(`${file}: a mesh ${(error as Error).message}`);
    }
  }
  return found;
}

// Every node of the scene with where it is, parents before their children.
function nodesOf(json: Gltf, file: string): { node: Node; matrix: Matrix4 }[] {
  const nodes = json.nodes ?? [];
  const children = new Set(nodes.flatMap((node) => node.children ?? []));
  const roots = json.scenes?.length ? json.scenes[json.scene ?? 0]?.nodes ?? [] : nodes.map((_, i) => i).filter((i) => !children.has(i));
  const found: { node: Node; matrix: Matrix4 }[] = [];
  const reached = new Set<number>();
  const open = roots.map((index) => ({ index, parent: new Matrix4() })).reverse();
  for (let next = open.pop(); next; next = open.pop()) {
    const { index, parent } = next;
    const node = nodes[index];
    if (!node) continue;
    if (reached.has(index)) throw new Error(`${file}: nodes[${index}] is reached twice, but a node has one parent. Export the file again.`);
    reached.add(index);
    const matrix = parent.clone().multiply(matrixOf(node));
    found.push({ node, matrix });
    for (const child of [...(node.children ?? [])].reverse()) open.push({ index: child, parent: matrix });
  }
  return found;
}

function matrixOf({ matrix, translation, rotation, scale }: Node): Matrix4 {
  if (matrix) return new Matrix4().fromArray(matrix);
  return new Matrix4().compose(
    new Vector3().fromArray(translation ?? [0, 0, 0]), new Quaternion().fromArray(rotation ?? [0, 0, 0, 1]).normalize(),
    new Vector3().fromArray(scale ?? [1, 1, 1]));
}

// A glTF camera is where its node is and looks along -z.
function cameraOf(json: Gltf, node: Node, matrix: Matrix4, stem: string): FileCamera | undefined {
  const perspective = json.cameras?.[node.camera ?? -1]?.perspective;
  if (!perspective) return undefined;
  const at = (x: number, y: number, z: number, w: number): { x: number; y: number; z: number } => {
    const e = matrix.elements;
    const [a, b, c] = [0, 1, 2].map((i) => x * (e[i] ?? 0) + y * (e[4 + i] ?? 0) + z * (e[8 + i] ?? 0) + w * (e[12 + i] ?? 0));
    return { x: a ?? 0, y: b ?? 0, z: c ?? 0 };
  };
  const near = Math.max(perspective.znear ?? 0, 1e-4);
  const far = perspective.zfar !== undefined && perspective.zfar > near ? perspective.zfar : near + 1000;
  const fovDegrees = (perspective.yfov ?? 0) * (180 / Math.PI);
  return { name: objectName(node.name, "camera", stem), eye: at(0, 0, 0, 1), target: at(0, 0, -1, 1), up: at(0, 1, 0, 0), near, far,
    ...(fovDegrees >= 1 && fovDegrees <= 170 ? { fovDegrees } : {}) };
}

// Primitives with the same numbers share their triangles, so that these are uploaded once.
class GltfMeshes {
  private readonly known = new Map<string, Triangles>();
  private readonly ofPacked = new Map<Unpacked, Map<number, Triangles>>();

  constructor(private readonly data: GltfData, private readonly file: string, private readonly unpacked: ReadonlyMap<Primitive, Unpacked>) {}

  // Undefined for points and lines, and for what has no positions.
  trianglesOf(primitive: Primitive, uvChannel: number): Triangles | undefined {
    const packed = this.unpacked.get(primitive);
    return packed ? this.trianglesOfPacked(packed, uvChannel) : this.trianglesOfPlain(primitive, uvChannel);
  }

  private trianglesOfPacked(packed: Unpacked, uvChannel: number): Triangles | undefined {
    const byChannel = this.ofPacked.get(packed) ?? new Map<number, Triangles>();
    this.ofPacked.set(packed, byChannel);
    const known = byChannel.get(uvChannel);
    if (known) return known;
    const values = (name: string, size: number): Float32Array | undefined => {
      const found = packed.attributes.get(name);
      return found?.components === size ? found.values : undefined;
    };
    const positions = values("POSITION", 3);
    const vertices = (positions?.length ?? 0) / 3;
    if (!positions || packed.indices.length < 3 || packed.indices.some((index) => index >= vertices)) return undefined;
    const normals = values("NORMAL", 3);
    const uvs = values(`TEXCOORD_${uvChannel}`, 2);
    const triangles = { positions, indices: packed.indices, ...(normals ? { normals } : {}), ...(uvs ? { uvs } : {}) };
    byChannel.set(uvChannel, triangles);
    return triangles;
  }

  private trianglesOfPlain({ attributes = {}, indices, mode = TRIANGLES }: Primitive, uvChannel: number): Triangles | undefined {
    const { POSITION: position, NORMAL: normal, [`TEXCOORD_${uvChannel}`]: uv } = attributes;
    if (position === undefined || mode < TRIANGLES || mode > FAN) return undefined;
    const key = [position, normal, uv, indices, mode].join();
    const known = this.known.get(key);
    if (known) return known;
    const positions = this.vectors(position, 3, "positions");
    const vertices = positions.length / 3;
    const corners = this.cornersOf(indices, vertices, mode);
    if (vertices < 3 || corners.length < 3) return undefined;
    const beside = (index: number | undefined, size: number, what: string): Float32Array | undefined => {
      const values = index === undefined ? undefined : this.vectors(index, size, what);
      return values?.length === vertices * size ? values : undefined;
    };
    const normals = beside(normal, 3, "normals");
    const uvs = beside(uv, 2, "texture coordinates");
    const triangles = { positions, indices: corners, ...(normals ? { normals } : {}), ...(uvs ? { uvs } : {}) };
    this.known.set(key, triangles);
    return triangles;
  }

  private vectors(accessor: number, size: number, what: string): Float32Array {
    const { values, components } = this.data.floats(accessor);
    if (components !== size) throw new Error(`${this.file}: accessors[${accessor}] has ${what} of ${components} numbers, glTF asks for ${size}. Export it again.`);
    return values;
  }

  private cornersOf(accessor: number | undefined, vertices: number, mode: number): Uint32Array {
    const listed = accessor === undefined ? Uint32Array.from({ length: vertices }, (_, i) => i) : this.data.whole(accessor);
    const wrong = listed.find((index) => index >= vertices);
    if (wrong !== undefined) {
      throw new Error(`${this.file}: accessors[${accessor}] names vertex ${wrong}, but there are ${vertices}, counted from 0. Export it again.`);
    }
    if (mode === TRIANGLES) return listed.slice(0, listed.length - (listed.length % 3));
    const out: number[] = [];
    const at = (i: number): number => listed[i] ?? 0;
    for (let i = 2; i < listed.length; ++i) {
      if (mode === FAN) out.push(at(0), at(i - 1), at(i));
      else if (mode === STRIP && i % 2 === 0) out.push(at(i - 2), at(i - 1), at(i));
      else out.push(at(i - 1), at(i - 2), at(i));
    }
    return Uint32Array.from(out);
  }
}
