import { TextureFormat } from "../../../gen/lpv/v1/blob_pb.ts";
import { AlphaMode } from "../../../gen/lpv/v1/scene_pb.ts";
import { clamped, colourFrom, emits, plainMaterial, radianceFrom, white, type Material, type Picture } from "./parts.ts";
import type { Pictures } from "./pictures.ts";

// What is said of one material, by keyword in small letters.
type Said = Map<string, string>;

// Options of a texture, each with as many words behind it as it may have.
const OPTIONS: Record<string, number> = {
  "-blendu": 1, "-blendv": 1, "-boost": 1, "-mm": 2, "-o": 3, "-s": 3, "-t": 3, "-texres": 1, "-type": 1, "-clamp": 1, "-bm": 1,
  "-imfchan": 1, "-cc": 1,
};
const MOST_BEND = 16; // of Surface.normal_scale

// The materials of an MTL file by name, by the rules of `lpvctl scene load`.
export async function readMtl(text: string, file: string, pictures: Pictures, warnings: string[]): Promise<Map<string, Material>> {
  const materials = new Map<string, Material>();
  for (const [name, said] of saidOf(text)) {
    const material = plainOf(said);
    if (emits(material)) {
      material.texture = await pictureOf(said, pictures, "map_ke", "colour");
    } else {
      if (said.has("map_d")) warnings.push(`${file}: the opacity texture of ${name} is left out. Put its values into the alpha of the colour's texture.`);
      material.texture = await pictureOf(said, pictures, "map_kd", "colour");
      material.normals = await pictureOf(said, pictures, "norm", "numbers");
      await readGloss(material, said, pictures, `${file}: the metalness texture of ${name}`, warnings);
    }
    materials.set(name, material);
  }
  return materials;
}

function saidOf(text: string): Map<string, Said> {
  const materials = new Map<string, Said>();
  let said: Said = new Map();
  for (const line of text.split(/\r?\n/)) {
    const [, keyword = "", rest = ""] = /^\s*(\S+)\s*(.*?)\s*$/.exec(line) ?? [];
    if (keyword === "newmtl") materials.set(rest, (said = new Map()));
    else if (keyword && !keyword.startsWith("#")) said.set(keyword.toLowerCase(), rest);
  }
  return materials;
}

function plainOf(said: Said): Material {
  const numbers = (keyword: string): number[] | undefined => said.get(keyword)?.split(/\s+/).map(Number);
  const one = (keyword: string): number | undefined => numbers(keyword)?.[0];
  const through = one("tr");
  const opacity = clamped(one("d") ?? (through === undefined ? undefined : 1 - through), 0, 1, 1);
  const material: Material = {
    ...plainMaterial(),
    radiance: radianceFrom(numbers("ke"), 1),
    albedo: said.has("kd") ? colourFrom(numbers("kd"), 1, 0) : white(0.6),
    roughness: clamped(one("pr"), 0, 1, 1),
    metalness: clamped(one("pm"), 0, 1, 0),
    normalScale: clamped(bend(said.get("norm")), 0, MOST_BEND, 1),
  };
  if (opacity === 1) return material;
  return { ...material, alphaMode: AlphaMode.BLEND, opacity, transmission: colourFrom(numbers("tf"), 1, 1) };
}

const bend = (texture: string | undefined): number | undefined => {
  const found = /(?:^|\s)-bm\s+(\S+)/.exec(texture ?? "");
  return found ? Number(found[1]) : undefined;
};

function pictureOf(said: Said, pictures: Pictures, keyword: string, use: "colour" | "numbers"): Promise<Picture | undefined> {
  const uri = fileIn(said.get(keyword) ?? "");
  return uri ? pictures.named(uri, use) : Promise.resolve(undefined);
}

// The name of the file, which may have spaces in it, without the options before it.
export function fileIn(texture: string): string {
  const words = texture.split(" ");
  for (let most = OPTIONS[words[0] ?? ""]; most !== undefined; most = OPTIONS[words[0] ?? ""]) {
    const isOfNumbers = most > 1;
    words.shift();
    for (let i = 0; i < most && words.length > 1 && (!isOfNumbers || Number.isFinite(Number(words[0]))); ++i) words.shift();
  }
  return words.join(" ");
}

// One picture of the roughness and the metalness, each of which is a picture of its own in MTL.
async function readGloss(material: Material, said: Said, pictures: Pictures, ofMetalness: string, warnings: string[]): Promise<void> {
  const roughness = await pictureOf(said, pictures, "map_pr", "numbers");
  let metalness = await pictureOf(said, pictures, "map_pm", "numbers");
  if (metalness) material.metalness = said.has("pm") ? material.metalness : 1;
  if (roughness && metalness && (roughness.width !== metalness.width || roughness.height !== metalness.height)) {
    warnings.push(`${ofMetalness} is left out, since it is not as large as that of the roughness.`);
    metalness = undefined;
  }
  const any = roughness ?? metalness;
  if (!any || any.format !== TextureFormat.RGB8_LINEAR) return;
  const texels = new Uint8Array(any.texels.length).fill(255);
  for (let i = 0; i < texels.length; i += 3) {
    if (roughness) texels[i + 1] = roughness.texels[i] ?? 255;
    if (metalness) texels[i + 2] = metalness.texels[i] ?? 255;
  }
  material.gloss = { ...any, texels };
}
