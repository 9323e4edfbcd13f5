import createDecoder, { type DracoModule, type DracoMesh } from "three/examples/jsm/libs/draco/gltf/draco_decoder.js";
import type { Numbers } from "./gltf_data.ts";

// The attributes of a mesh by their glTF names, and its triangles.
export interface Unpacked {
  attributes: Map<string, Numbers & { values: Float32Array }>;
  indices: Uint32Array;
}

let started: Promise<DracoModule> | undefined;

// What KHR_draco_mesh_compression holds of `wanted`: numbers of its attributes by their glTF names. The accessor decides
// whether whole numbers are normalised, whatever the packed mesh says.
export async function decodeDraco(bytes: Uint8Array, wanted: Record<string, number>, isNormalised: (name: string) => boolean): Promise<Unpacked> {
  const draco = await (started ??= createDecoder());
  const decoder = new draco.Decoder();
  const mesh = new draco.Mesh();
  try {
    if (!decoder.DecodeArrayToMesh(new Int8Array(bytes.slice().buffer), bytes.length, mesh).ok() || mesh.ptr === 0) {
      throw new Error("is damaged: its bytes are not what KHR_draco_mesh_compression writes; export the file again.");
    }
    const attributes = new Map<string, Numbers & { values: Float32Array }>();
    for (const [name, id] of Object.entries(wanted)) {
      const attribute = decoder.GetAttributeByUniqueId(mesh, id);
      if (attribute.ptr === 0) throw new Error(`says that ${name} is attribute ${id} of a packed mesh, which has none of this number; export it again.`);
      const values = new draco.DracoFloat32Array();
      decoder.GetAttributeFloatForAllPoints(mesh, attribute, values);
      const floats = Float32Array.from({ length: values.size() }, (_, i) => values.GetValue(i));
      draco.destroy(values);
      const components = attribute.num_components();
      attributes.set(name, { components, values: scaled(floats, attribute.normalized(), isNormalised(name), LARGEST[attribute.data_type()] ?? 1) });
    }
    return { attributes, indices: trianglesOf(draco, decoder, mesh) };
  } finally {
    draco.destroy(mesh);
    draco.destroy(decoder);
  }
}

const LARGEST: Record<number, number> = { 1: 127, 2: 255, 3: 32767, 4: 65535 }; // by Draco's types: int8, uint8, int16, uint16

function scaled(values: Float32Array, was: boolean, wanted: boolean, largest: number): Float32Array {
  if (was === wanted) return values;
  return values.map((value) => (wanted ? Math.max(-1, value / largest) : value * largest));
}

function trianglesOf(draco: DracoModule, decoder: InstanceType<DracoModule["Decoder"]>, mesh: DracoMesh): Uint32Array {
  const count = 3 * mesh.num_faces();
  const at = draco._malloc(4 * count);
  decoder.GetTrianglesUInt32Array(mesh, 4 * count, at);
  const out = new Uint32Array(draco.HEAPF32.buffer, at, count).slice();
  draco._free(at);
  return out;
}
