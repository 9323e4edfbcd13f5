import { Vector3 } from "three";
import { lastPart, type DroppedFiles } from "./dropped_files.ts";
import { readMtl } from "./mtl.ts";
import { NO_PLACEMENT, objectName, plainMaterial, stemOf, white, type FileContent, type Material, type Triangles } from "./parts.ts";
import { Pictures } from "./pictures.ts";
import { appendTriangles } from "./polygons.ts";

// The triangles of one object or group that have one material.
interface Piece {
  name: string; // of the object or group; empty before the first
  material: string;
  corners: Map<string, number>; // "v/vt/vn" -> vertex
  vertices: number[]; // where each vertex has its position, texture coordinates and normal, -1 without; three a vertex
  indices: number[];
}

// A Wavefront OBJ with its materials: one part per object or group and material.
export async function readObj(file: File, files: DroppedFiles, warnings: string[]): Promise<FileContent> {
  const text = new ObjText(file.name);
  const lines = (await file.text()).replaceAll(/\\\r?\n/g, " ").split(/\r?\n/);
  lines.forEach((line, i) => text.add(line.trim(), i + 1));
  const pictures = new Pictures(files, file.name, warnings);
  const materials = new Map<string, Material>();
  for (const library of text.libraries) {
    const found = files.find(library);
    if (found) for (const [name, material] of await readMtl(await found.text(), found.name, pictures, warnings)) materials.set(name, material);
    else warnings.push(`${file.name} is without its materials, since ${lastPart(library)} was not dropped: drop both together.`);
  }
  const stem = stemOf(file.name);
  const parts = text.pieces.map((piece) => ({
    name: objectName(piece.name, stem), triangles: text.trianglesOf(piece), placement: NO_PLACEMENT,
    material: materials.get(piece.material) ?? withoutMtl(),
  }));
  return { parts, cameras: [] };
}

// What faces are made of whose material is not there.
export const withoutMtl = (): Material => ({ ...plainMaterial(), albedo: white(0.6) });

const KINDS = [["vertex", 3], ["texture coordinate", 2], ["normal", 3]] as const;

class ObjText {
  readonly libraries: string[] = [];
  private readonly numbers: [number[], number[], number[]] = [[], [], []]; // positions, texture coordinates, normals
  private readonly made = new Map<string, Piece>();
  private name = "";
  private material = "";

  constructor(private readonly file: string) {}

  get pieces(): Piece[] {
    return [...this.made.values()];
  }

  add(line: string, number: number): void {
    const [keyword = ""] = line.split(/\s/, 1);
    const rest = line.slice(keyword.length).trim();
    const words = (): string[] => rest.replace(/#.*/, "").trim().split(/\s+/);
    if (keyword === "v") this.vector(0, words(), number);
    else if (keyword === "vt") this.vector(1, words(), number);
    else if (keyword === "vn") this.vector(2, words(), number);
    else if (keyword === "f") this.face(words(), number);
    else if (keyword === "o") this.name = rest.split(/\s/, 1)[0] ?? "";
    else if (keyword === "g") this.name = rest;
    else if (keyword === "usemtl") this.material = rest;
    else if (keyword === "mtllib") this.libraries.push(rest);
  }

  trianglesOf({ vertices, indices }: Piece): Triangles {
    const gathered = (kind: 0 | 1 | 2, size: number): Float32Array => {
      const out = new Float32Array((vertices.length / 3) * size);
      for (let i = 0; i < vertices.length / 3; ++i) {
        for (let c = 0; c < size; ++c) out[i * size + c] = this.numbers[kind][(vertices[3 * i + kind] ?? 0) * size + c] ?? 0;
      }
      return out;
    };
    const all = (kind: 1 | 2): boolean => vertices.every((at, i) => i % 3 !== kind || at >= 0);
    const uvs = all(1) ? gathered(1, 2).map((value, i) => (i % 2 === 1 ? 1 - value : value)) : undefined; // v goes up in OBJ
    return {
      positions: gathered(0, 3), indices: Uint32Array.from(indices),
      ...(all(2) ? { normals: gathered(2, 3) } : {}), ...(uvs ? { uvs } : {}),
    };
  }

  private vector(kind: 0 | 1 | 2, words: readonly string[], line: number): void {
    const [what, size] = KINDS[kind];
    for (let c = 0; c < size; ++c) {
      const value = Number(words[c] || (kind === 1 && c === 1 ? 0 : NaN));
      if (!Number.isFinite(value)) throw new Error(`${this.file}, line ${line}: a ${what} needs ${size} numbers. Export the file again.`);
      this.numbers[kind].push(value);
    }
  }

  private face(words: readonly string[], line: number): void {
    if (words.length < 3) return; // shows nothing
    const piece = this.piece();
    const corners = words.map((word) => this.corner(piece, word, line));
    appendTriangles(corners, (corner) => new Vector3().fromArray(this.numbers[0], 3 * (piece.vertices[3 * corner] ?? 0)), piece.indices);
  }

  private piece(): Piece {
    const key = `${this.name}\n${this.material}`;
    const known = this.made.get(key);
    if (known) return known;
    const piece: Piece = { name: this.name, material: this.material, corners: new Map(), vertices: [], indices: [] };
    this.made.set(key, piece);
    return piece;
  }

  private corner(piece: Piece, word: string, line: number): number {
    const at = word.split("/").map((text, kind) => this.place(text, kind, word, line));
    const key = at.join("/");
    const known = piece.corners.get(key);
    if (known !== undefined) return known;
    const vertex = piece.vertices.length / 3;
    piece.vertices.push(at[0] ?? -1, at[1] ?? -1, at[2] ?? -1);
    piece.corners.set(key, vertex);
    return vertex;
  }

  // Counted from 1, or from -1 backwards from what has been given so far.
  private place(text: string, kind: number, word: string, line: number): number {
    if (text === "" && kind > 0) return -1;
    const [what, size] = KINDS[kind] ?? [];
    const index = Number(text);
    if (!what || !size || !Number.isInteger(index)) {
      throw new Error(`${this.file}, line ${line}: '${word}' is no corner of a face, which is v, v/vt, v//vn or v/vt/vn. Export the file again.`);
    }
    const count = (this.numbers[kind]?.length ?? 0) / size;
    const at = index > 0 ? index - 1 : count + index;
    if (index === 0 || at < 0 || at >= count) {
      throw new Error(`${this.file}, line ${line}: ${what} ${index} is out of range, since there are ${count} before it. Export the file again.`);
    }
    return at;
  }
}
