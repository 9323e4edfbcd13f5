import type { MessageInitShape } from "@bufbuild/protobuf";
import { TextureFormat } from "../../../gen/lpv/v1/blob_pb.ts";
import type { CameraSchema } from "../../../gen/lpv/v1/geometry_pb.ts";
import { AlphaMode } from "../../../gen/lpv/v1/scene_pb.ts";
import type { Colour } from "../emission.ts";
import type { Placement } from "../placement.ts";

// Triangles in the object's own space. Parts of a file that have the same triangles share one of these.
export interface Triangles {
  positions: Float32Array; // x, y, z
  indices: Uint32Array;
  normals?: Float32Array; // x, y, z
  uvs?: Float32Array; // u, v; (0, 0) is the top left of a picture
}

// Rows from top to bottom.
export interface Picture {
  width: number;
  height: number;
  format: TextureFormat;
  texels: Uint8Array;
}

// What a light or a surface can use of a file's material; the fields mean what those of Light and Surface do.
export interface Material {
  radiance: Colour; // 0: does not emit
  albedo: Colour;
  roughness: number;
  metalness: number;
  doubleSided: boolean;
  oneSidedSurface: boolean; // the file says that back faces are not drawn
  alphaMode: AlphaMode;
  alphaCutoff: number;
  opacity: number;
  transmission: Colour;
  texture?: Picture | undefined; // multiplies the radiance of what emits, else the albedo
  normals?: Picture | undefined;
  normalScale: number;
  gloss?: Picture | undefined; // its green multiplies the roughness, its blue the metalness
  uvChannel: number; // the texture coordinates that the pictures are laid out by
}

// One mesh at one place, of one material: what becomes a light or a surface.
export interface Part {
  name: string;
  triangles: Triangles;
  placement: Placement;
  material: Material;
}

export type FileCamera = MessageInitShape<typeof CameraSchema>;

// What is read of one file.
export interface FileContent {
  parts: Part[];
  cameras: FileCamera[];
}

const LARGEST_RADIANCE = 1e9;

export const white = (value: number): Colour => ({ x: value, y: value, z: value });
export const NO_PLACEMENT: Placement = {
  translation: { x: 0, y: 0, z: 0 }, rotation: { x: 0, y: 0, z: 0, w: 1 }, scale: { x: 1, y: 1, z: 1 },
};

// What a file without materials is made of, as lpvctl has it.
export function plainMaterial(): Material {
  return {
    radiance: white(0), albedo: white(0.8), roughness: 1, metalness: 0, doubleSided: false, oneSidedSurface: false,
    alphaMode: AlphaMode.OPAQUE, alphaCutoff: 0.5, opacity: 1, transmission: white(1), normalScale: 1, uvChannel: 0,
  };
}

export const emits = ({ radiance }: Material): boolean => radiance.x > 0 || radiance.y > 0 || radiance.z > 0;

export function clamped(value: number | undefined, low: number, high: number, otherwise: number): number {
  return value !== undefined && Number.isFinite(value) ? Math.min(high, Math.max(low, value)) : otherwise;
}

// Three numbers of a file as a colour, each at most `most`.
export function colourFrom(values: readonly (number | undefined)[] | undefined, most: number, otherwise: number): Colour {
  const at = (i: number): number => clamped(values?.[i], 0, most, otherwise);
  return { x: at(0), y: at(1), z: at(2) };
}

export const radianceFrom = (factor: readonly number[] | undefined, strength: number): Colour =>
  colourFrom(factor?.map((value) => value * strength), LARGEST_RADIANCE, 0);

const BYTES_IN_NAME = 200;

// The first of these that says something, as the session takes names.
export function objectName(...candidates: (string | undefined)[]): string {
  const best = candidates.find((one) => one && !one.startsWith("<")) ?? "object";
  let name = "";
  let bytes = 0;
  for (const letter of best.replace(/[\p{Cc}\p{Cs}\p{Zl}\p{Zp}\p{Bidi_Control}\p{Default_Ignorable_Code_Point}/]/gu, "_")) {
    bytes += new TextEncoder().encode(letter).length;
    if (bytes > BYTES_IN_NAME) break;
    name += letter;
  }
  return name;
}

export const stemOf = (fileName: string): string => fileName.replace(/\.[^.]*$/, "");

export const hasAlpha = (picture: Picture): boolean => picture.format === TextureFormat.RGBA8_SRGB;
