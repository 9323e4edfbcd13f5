import { bytesWithin, lastPart, type DroppedFiles } from "./dropped_files.ts";
import type { Accessor, Gltf, Slice } from "./gltf_json.ts";
import type { decodeMeshopt } from "./meshopt.ts";

export interface Numbers {
  values: Float32Array | Uint32Array;
  components: number; // of one of them
}

const COMPONENTS: Record<string, number> = { SCALAR: 1, VEC2: 2, VEC3: 3, VEC4: 4 };

interface Kind {
  bytes: number;
  read(view: DataView, at: number): number;
  full: number; // what a normalised 1 is stored as
}

const KINDS: Record<number, Kind> = {
  5120: { bytes: 1, read: (view, at) => view.getInt8(at), full: 127 },
  5121: { bytes: 1, read: (view, at) => view.getUint8(at), full: 255 },
  5122: { bytes: 2, read: (view, at) => view.getInt16(at, true), full: 32767 },
  5123: { bytes: 2, read: (view, at) => view.getUint16(at, true), full: 65535 },
  5125: { bytes: 4, read: (view, at) => view.getUint32(at, true), full: 4294967295 },
  5126: { bytes: 4, read: (view, at) => view.getFloat32(at, true), full: 1 },
};
const MOST_NUMBERS = 2 ** 28;

// The numbers and bytes that a glTF's JSON refers to.
export class GltfData {
  private readonly known = new Map<string, Numbers>();
  private readonly unpacked = new Map<number, Uint8Array<ArrayBuffer>>();

  private constructor(private readonly json: Gltf, private readonly buffers: readonly Uint8Array<ArrayBuffer>[], private readonly name: string,
    private readonly unpack: typeof decodeMeshopt | undefined) {}

  static async open(json: Gltf, chunk: Uint8Array, file: File, files: DroppedFiles): Promise<GltfData> {
    const buffers: Uint8Array<ArrayBuffer>[] = [];
    for (const { uri } of json.buffers ?? []) {
      buffers.push(uri === undefined ? (chunk as Uint8Array<ArrayBuffer>) : bytesWithin(uri) ?? (await fileOf(uri, file, files)));
    }
    const isPacked = json.bufferViews?.some((view) => view.extensions?.EXT_meshopt_compression);
    return new GltfData(json, buffers, file.name, isPacked ? (await import("./meshopt.ts")).decodeMeshopt : undefined);
  }

  view(index: number): Uint8Array<ArrayBuffer> {
    const view = this.at(this.json.bufferViews, index, "bufferViews");
    const packed = view.extensions?.EXT_meshopt_compression;
    if (!packed || !this.unpack) return this.slice(view, index);
    const known = this.unpacked.get(index);
    if (known) return known;
    const { count = 0, byteStride: stride = 0, mode = "", filter = "NONE" } = packed;
    try {
      const bytes = this.unpack({ bytes: this.slice(packed, index), count, stride, mode, filter });
      this.unpacked.set(index, bytes);
      return bytes;
    } catch (error) {
      throw new Error(`${this.name}: bufferViews[${index}] ${(error as Error).message}`);
    }
  }

  isNormalised(accessor: number | undefined): boolean {
    return this.json.accessors?.[accessor ?? -1]?.normalized === true;
  }

  private slice({ buffer, byteOffset = 0, byteLength = 0 }: Slice, index: number): Uint8Array<ArrayBuffer> {
    const bytes = this.at(this.buffers, buffer, "buffers");
    if (byteOffset + byteLength > bytes.length) {
      throw new Error(`${this.name} is cut short: bufferViews[${index}] ends ${byteOffset + byteLength - bytes.length} bytes behind its buffer. Export it again.`);
    }
    return bytes.subarray(byteOffset, byteOffset + byteLength);
  }

  floats(index: number): Numbers & { values: Float32Array } {
    return this.once(index, "floats", (length) => new Float32Array(length)) as Numbers & { values: Float32Array };
  }

  whole(index: number): Uint32Array {
    return this.once(index, "whole", (length) => new Uint32Array(length)).values as Uint32Array;
  }

  private once(index: number, as: string, made: (length: number) => Numbers["values"]): Numbers {
    const key = `${as} ${index}`;
    const known = this.known.get(key);
    if (known) return known;
    const read = this.read(index, made);
    this.known.set(key, read);
    return read;
  }

  private read(index: number, made: (length: number) => Numbers["values"]): Numbers {
    const accessor = this.at(this.json.accessors, index, "accessors");
    const components = COMPONENTS[accessor.type ?? ""];
    const kind = KINDS[accessor.componentType ?? 0];
    const count = accessor.count ?? 0;
    if (!components || !kind || count < 0 || count * components > MOST_NUMBERS) {
      throw new Error(`${this.name}: accessors[${index}] is none of glTF 2.0. Export the file again.`);
    }
    const values = made(count * components);
    if (accessor.bufferView !== undefined) {
      const stride = this.json.bufferViews?.[accessor.bufferView]?.byteStride || kind.bytes * components;
      this.fill(values, accessor, kind, components, accessor.bufferView, stride);
    }
    if (accessor.sparse) this.override(values, accessor.sparse, kind, components, accessor.normalized === true);
    return { values, components };
  }

  private fill(values: Numbers["values"], accessor: Accessor, kind: Kind, components: number, from: number, stride: number): void {
    const view = viewOf(this.view(from));
    const start = accessor.byteOffset ?? 0;
    const count = values.length / components;
    const end = count > 0 ? start + (count - 1) * stride + kind.bytes * components : start;
    if (end > view.byteLength) throw new Error(`${this.name} is cut short: an accessor of ${count} ends behind bufferViews[${from}]. Export it again.`);
    for (let i = 0, to = 0; i < count; ++i) {
      for (let c = 0; c < components; ++c) values[to++] = valueAt(view, start + i * stride + c * kind.bytes, kind, accessor.normalized === true);
    }
  }

  private override(values: Numbers["values"], { count, indices, values: others }: NonNullable<Accessor["sparse"]>, kind: Kind, components: number, normalised: boolean): void {
    const places = viewOf(this.view(indices.bufferView).subarray(indices.byteOffset ?? 0));
    const from = viewOf(this.view(others.bufferView).subarray(others.byteOffset ?? 0));
    const index = KINDS[indices.componentType];
    if (!index || count * index.bytes > places.byteLength || count * components * kind.bytes > from.byteLength) {
      throw new Error(`${this.name}: a sparse accessor has less than its ${count} values. Export the file again.`);
    }
    for (let i = 0; i < count; ++i) {
      const to = index.read(places, i * index.bytes) * components;
      for (let c = 0; c < components; ++c) values[to + c] = valueAt(from, (i * components + c) * kind.bytes, kind, normalised);
    }
  }

  private at<T>(list: readonly T[] | undefined, index: number | undefined, of: string): T {
    const found = list?.[index ?? -1];
    if (found === undefined) throw new Error(`${this.name} refers to ${of}[${index}], which it does not have. Export it again.`);
    return found;
  }
}

async function fileOf(uri: string, file: File, files: DroppedFiles): Promise<Uint8Array<ArrayBuffer>> {
  const found = files.find(uri);
  if (!found) throw new Error(`${file.name} needs ${lastPart(uri)}: drop both together.`);
  return new Uint8Array(await found.arrayBuffer());
}

const viewOf = (bytes: Uint8Array): DataView => new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);

function valueAt(view: DataView, at: number, kind: Kind, normalised: boolean): number {
  const value = kind.read(view, at);
  return normalised ? Math.max(value / kind.full, -1) : value;
}
