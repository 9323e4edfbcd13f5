import { Vector3 } from "three";
import { smoothNormals } from "./normals.ts";
import { NO_PLACEMENT, objectName, plainMaterial, stemOf, type FileContent, type Triangles } from "./parts.ts";
import { readPlyHeader, type PlyElement, type PlyProperty } from "./ply_header.ts";
import { appendTriangles } from "./polygons.ts";

// A PLY: one mesh without a material. Scans without normals get smooth ones, as lpvctl has them.
export async function readPly(file: File): Promise<FileContent> {
  const bytes = new Uint8Array(await file.arrayBuffer());
  try {
    return { parts: [{ name: objectName(stemOf(file.name)), triangles: plyMesh(bytes), placement: NO_PLACEMENT, material: plainMaterial() }], cameras: [] };
  } catch (error) {
    throw new Error(`${file.name}: ${(error as Error).message}`);
  }
}

export function plyMesh(bytes: Uint8Array): Triangles {
  const header = readPlyHeader(bytes);
  const body = bytes.subarray(header.bytes);
  const values = header.format === "ascii" ? new TextValues(body) : new BinaryValues(body, header.format === "binary_little_endian");
  const mesh = new PlyMesh();
  for (const element of header.elements) mesh.take(element, values);
  return mesh.finish();
}

interface Values {
  next(type: PlyProperty["type"]): number;
  readonly ended: boolean; // more was asked for than there is
}

class BinaryValues implements Values {
  private readonly view: DataView;
  private at = 0;
  ended = false;

  constructor(bytes: Uint8Array, private readonly little: boolean) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  next({ bytes, get }: PlyProperty["type"]): number {
    this.ended ||= this.at + bytes > this.view.byteLength;
    if (this.ended) return 0;
    const value = get(this.view, this.at, this.little);
    this.at += bytes;
    return value;
  }
}

class TextValues implements Values {
  private readonly words: string[];
  private at = 0;
  ended = false;

  constructor(bytes: Uint8Array) {
    this.words = new TextDecoder().decode(bytes).trim().split(/\s+/);
  }

  next(): number {
    const value = Number(this.words[this.at++]);
    this.ended ||= Number.isNaN(value);
    return this.ended ? 0 : value;
  }
}

const UVS = [["s", "t"], ["u", "v"], ["texture_u", "texture_v"], ["texture_s", "texture_t"]] as const;
const LISTS = new Set(["vertex_indices", "vertex_index"]);

class PlyMesh {
  private vertices: Map<string, Float32Array> = new Map();
  private count = 0;
  private readonly lists: { strip: boolean; corners: number[] }[] = [];

  take(element: PlyElement, values: Values): void {
    const columns = new Map(element.properties.filter(({ count }) => !count).map(({ name }) => [name, new Float32Array(element.name === "vertex" ? element.count : 0)]));
    for (let i = 0; element.properties.length > 0 && i < element.count; ++i) {
      for (const property of element.properties) {
        const items = property.count ? values.next(property.count) : 1;
        const corners: number[] = [];
        for (let k = 0; k < items && !values.ended; ++k) corners.push(values.next(property.type));
        if (values.ended) throw cutShort(element, i);
        const column = columns.get(property.name);
        if (!property.count && column) column[i] = corners[0] ?? 0;
        const holdsCorners = element.name === "face" || element.name === "tristrips";
        if (property.count && holdsCorners && LISTS.has(property.name)) this.lists.push({ strip: element.name === "tristrips", corners });
      }
    }
    if (element.name !== "vertex") return;
    this.vertices = columns;
    this.count = element.count;
  }

  finish(): Triangles {
    if (this.lists.length === 0) throw new Error("it has no face, only vertices; export it with faces.");
    const positions = this.columns("x", "y", "z");
    if (!positions) throw new Error("its vertices have no x, y and z.");
    const indices = this.triangles(positions);
    const normals = this.columns("nx", "ny", "nz") ?? smoothNormals(positions, indices);
    const [u, v] = UVS.find(([name]) => this.vertices.has(name)) ?? ["s", "t"];
    const uvs = this.columns(u, v)?.map((value, i) => (i % 2 === 1 ? 1 - value : value)); // its rows count from the bottom
    return { positions, indices, normals, ...(uvs ? { uvs } : {}) };
  }

  private columns(...names: string[]): Float32Array | undefined {
    const found = names.map((name) => this.vertices.get(name));
    if (found.includes(undefined)) return undefined;
    const out = new Float32Array(this.count * names.length);
    for (let i = 0; i < this.count; ++i) found.forEach((column, c) => (out[names.length * i + c] = column?.[i] ?? 0));
    return out;
  }

  private triangles(positions: Float32Array): Uint32Array {
    const out: number[] = [];
    this.lists.forEach(({ strip, corners }, i) => {
      for (const corner of corners) {
        if (Number.isInteger(corner) && corner < this.count && corner >= (strip ? -1 : 0)) continue;
        throw new Error(`face ${i}: vertex ${corner} is out of range; the file has ${this.count} vertices, numbered from 0; export it again.`);
      }
      if (strip) appendStrip(corners, out);
      else appendTriangles(corners, (corner) => new Vector3().fromArray(positions, 3 * corner), out);
    });
    return Uint32Array.from(out);
  }
}

const cutShort = (element: PlyElement, found: number): Error =>
  new Error(`it is cut short: ${found} complete elements of "${element.name}", its header announces ${element.count}; copy or export it again.`);

// Every second triangle is wound the other way round; -1 begins another strip.
function appendStrip(strip: readonly number[], out: number[]): void {
  let begin = 0;
  strip.forEach((corner, i) => {
    if (corner < 0) begin = i + 1;
    if (corner < 0 || i < begin + 2) return;
    const odd = (i - begin) % 2;
    out.push(strip[i - 2 + odd]!, strip[i - 1 - odd]!, corner);
  });
}
