import { DroppedFiles } from "./dropped_files.ts";
import { HIGH_RANGE, readHighRange } from "./high_range.ts";
import { emits, NO_PLACEMENT, objectName, plainMaterial, stemOf, white, type FileCamera, type FileContent, type Part, type Picture } from "./parts.ts";
import { readPicture } from "./texels.ts";

// What one file becomes.
export interface FileScene {
  file: string;
  lights: Part[];
  surfaces: Part[];
  cameras: FileCamera[];
  dark?: FileContent; // of a file in which nothing emits: what it says, from which its lights were made
}

// A picture of all that is far away.
export interface Sky {
  name: string;
  picture: Picture;
}

export interface Dropped {
  scenes: FileScene[];
  skies: Sky[];
  warnings: string[]; // sentences about what was left out
}

const PICTURE = /\.(png|jpe?g|webp|gif|bmp|avif)$/i;
const MODEL = /\.(glb|gltf|obj|ply)$/i;
const COMPANION = /\.(bin|mtl)$/i; // says nothing alone
const PICTURE_WIDTH = 1.6; // metres, of a picture as a television
const PLAIN_RADIANCE = 5;

// Reads the files that people drop or choose together: models become lights and surfaces, a picture that no model asks for
// a television, one with a high range the sky.
export async function readDropped(given: readonly File[]): Promise<Dropped> {
  const files = new DroppedFiles(given);
  const dropped: Dropped = { scenes: [], skies: [], warnings: [] };
  for (const file of given) {
    if (MODEL.test(file.name)) dropped.scenes.push(sceneOf(file.name, await readModel(file, files, dropped.warnings)));
    else if (!isPicture(file) && !HIGH_RANGE.test(file.name) && !COMPANION.test(file.name)) throw notTaken(file);
  }
  for (const file of given) {
    if (files.isPartOfAnother(file)) continue;
    if (HIGH_RANGE.test(file.name)) dropped.skies.push({ name: objectName(stemOf(file.name)), picture: await readHighRange(file) });
    else if (isPicture(file)) dropped.scenes.push(sceneOf(file.name, await television(file)));
  }
  if (dropped.skies.length === 0 && dropped.scenes.every(({ lights, surfaces }) => lights.length + surfaces.length === 0)) {
    throw new Error("There are no triangles in what was dropped.");
  }
  return dropped;
}

const isPicture = (file: File): boolean => PICTURE.test(file.name) || (file.type.startsWith("image/") && !HIGH_RANGE.test(file.name));

function notTaken(file: File): Error {
  return new Error(`${file.name}: what can be dropped is GLB, glTF with its .bin, OBJ with its .mtl, PLY, each with its pictures, pictures alone, ` +
    "and HDR or EXR for the sky.");
}

// Readers are loaded when they are needed.
async function readModel(file: File, files: DroppedFiles, warnings: string[]): Promise<FileContent> {
  if (/\.ply$/i.test(file.name)) return (await import("./ply.ts")).readPly(file);
  if (/\.obj$/i.test(file.name)) return (await import("./obj.ts")).readObj(file, files, warnings);
  return (await import("./gltf.ts")).readGltf(file, files, warnings);
}

// Where some of a file emits, the rest of it is what is lit. A file in which nothing does is dropped to be a light.
export function sceneOf(file: string, content: FileContent): FileScene {
  const { parts, cameras } = content;
  const lights = parts.filter(({ material }) => emits(material));
  if (lights.length > 0) return { file, lights, surfaces: parts.filter(({ material }) => !emits(material)), cameras };
  return { file, lights: parts.map(asPlainLight), surfaces: [], cameras: [], dark: content };
}

function asPlainLight(part: Part): Part {
  return { ...part, material: { ...plainMaterial(), radiance: white(PLAIN_RADIANCE), doubleSided: part.material.doubleSided } };
}

async function television(file: File): Promise<FileContent> {
  const texture = await readPicture(file, file.name, "colour");
  const x = PICTURE_WIDTH / 2;
  const y = (x * texture.height) / texture.width;
  const triangles = {
    positions: Float32Array.of(-x, -y, 0, x, -y, 0, x, y, 0, -x, y, 0), indices: Uint32Array.of(0, 1, 2, 0, 2, 3),
    uvs: Float32Array.of(0, 1, 1, 1, 1, 0, 0, 0),
  };
  const material = { ...plainMaterial(), radiance: white(PLAIN_RADIANCE), texture };
  return { parts: [{ name: objectName(stemOf(file.name)), triangles, placement: NO_PLACEMENT, material }], cameras: [] };
}
