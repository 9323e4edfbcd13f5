import { TextureFormat } from "../../../gen/lpv/v1/blob_pb.ts";
import { AlphaMode } from "../../../gen/lpv/v1/scene_pb.ts";
import type { Colour } from "../emission.ts";
import type { GltfData } from "./gltf_data.ts";
import type { Gltf, GltfMaterial, TextureOf } from "./gltf_json.ts";
import { clamped, colourFrom, emits, plainMaterial, radianceFrom, white, type Material, type Picture } from "./parts.ts";
import { meanColour, type Pictures } from "./pictures.ts";
import type { Use } from "./texels.ts";

const MODES: Record<string, AlphaMode> = { MASK: AlphaMode.MASK, BLEND: AlphaMode.BLEND };
const MOST_BEND = 16; // of Surface.normal_scale

// The materials of a glTF as lights and surfaces can use them, by the rules of `lpvctl scene load`.
export class GltfMaterials {
  private readonly known = new Map<number, Promise<Material>>();

  constructor(private readonly json: Gltf, private readonly data: GltfData, private readonly pictures: Pictures,
    private readonly file: string, private readonly warnings: string[]) {}

  // Without an index, or with one that leads nowhere: glTF's own default.
  at(index: number | undefined): Promise<Material> {
    const key = index !== undefined && this.json.materials?.[index] ? index : -1;
    const known = this.known.get(key);
    if (known) return known;
    const reading = this.read(this.json.materials?.[key] ?? {});
    this.known.set(key, reading);
    return reading;
  }

  private async read(given: GltfMaterial): Promise<Material> {
    const pbr = given.pbrMetallicRoughness ?? {};
    const material: Material = {
      ...plainMaterial(),
      radiance: radianceFrom(given.emissiveFactor, given.extensions?.KHR_materials_emissive_strength?.emissiveStrength ?? 1),
      albedo: colourFrom(pbr.baseColorFactor, 1, 1),
      roughness: clamped(pbr.roughnessFactor, 0, 1, 1),
      metalness: clamped(pbr.metallicFactor, 0, 1, 1),
      doubleSided: given.doubleSided === true,
      oneSidedSurface: given.doubleSided !== true,
    };
    if (emits(material)) {
      material.texture = await this.picture(given.emissiveTexture, "colour", given);
      material.uvChannel = given.emissiveTexture?.texCoord ?? 0;
      return material;
    }
    const transmits = clamped(given.extensions?.KHR_materials_transmission?.transmissionFactor, 0, 1, 0);
    const ofTexture = MODES[given.alphaMode ?? ""] ?? AlphaMode.OPAQUE;
    readAlpha(material, given, ofTexture, transmits);
    await this.readPictures(material, given, ofTexture);
    const tints = ofTexture === AlphaMode.BLEND || transmits > 0;
    if (tints && material.alphaMode === AlphaMode.BLEND && material.texture?.format === TextureFormat.RGB8_SRGB) {
      material.transmission = multiplied(material.transmission, meanColour(material.texture));
    }
    return material;
  }

  private async readPictures(material: Material, given: GltfMaterial, ofTexture: AlphaMode): Promise<void> {
    const pbr = given.pbrMetallicRoughness ?? {};
    const colour = pbr.baseColorTexture ?? given.extensions?.KHR_materials_pbrSpecularGlossiness?.diffuseTexture;
    material.texture = await this.picture(colour, ofTexture === AlphaMode.OPAQUE ? "colour" : "colour with alpha", given);
    material.uvChannel = colour?.texCoord ?? 0;
    material.normals = await this.numbers(given.normalTexture, "normal", material, given);
    material.normalScale = clamped(given.normalTexture?.scale, 0, MOST_BEND, 1);
    material.gloss = await this.numbers(pbr.metallicRoughnessTexture, "roughness", material, given);
  }

  // A mesh has one set of texture coordinates in a session: that of the first picture.
  private async numbers(texture: TextureOf | undefined, what: string, material: Material, given: GltfMaterial): Promise<Picture | undefined> {
    if (!texture) return undefined;
    const channel = texture.texCoord ?? 0;
    if ((material.texture || material.normals) && channel !== material.uvChannel) {
      this.warnings.push(`${this.file}: the ${what} texture of ${named(given)} is left out, since it has other texture coordinates than its other textures.`);
      return undefined;
    }
    material.uvChannel = channel;
    return this.picture(texture, "numbers", given);
  }

  private async picture(texture: TextureOf | undefined, use: Use, given: GltfMaterial): Promise<Picture | undefined> {
    const one = this.json.textures?.[texture?.index ?? -1];
    if (!texture || !one) return undefined;
    const index = one.source ?? one.extensions?.EXT_texture_webp?.source;
    const image = this.json.images?.[index ?? -1];
    if (!image) {
      this.warnings.push(`${this.file}: a texture of ${named(given)} is left out, since it is of a kind that the page does not read. Convert it to PNG.`);
      return undefined;
    }
    if (texture.extensions?.KHR_texture_transform) {
      this.warnings.push(`${this.file}: a texture of ${named(given)} lies as if it had no KHR_texture_transform.`);
    }
    if (image.uri !== undefined) return this.pictures.named(image.uri, use);
    if (image.bufferView === undefined) return undefined;
    return this.pictures.within(`bufferView ${image.bufferView}`, this.data.view(image.bufferView), use);
  }
}

const named = (given: GltfMaterial): string => given.name ?? "a material without name";

// The share that is covered is the alpha of the base colour; KHR_materials_transmission takes its factor off it. What
// glass lets through has its base colour.
function readAlpha(material: Material, given: GltfMaterial, mode: AlphaMode, transmits: number): void {
  material.alphaMode = mode;
  material.alphaCutoff = clamped(given.alphaCutoff, 0, 1, 0.5);
  if (mode !== AlphaMode.OPAQUE) material.opacity = clamped(given.pbrMetallicRoughness?.baseColorFactor?.[3], 0, 1, 1);
  material.transmission = mode === AlphaMode.BLEND ? material.albedo : white(1);
  if (transmits === 0 || mode === AlphaMode.MASK) return;
  material.alphaMode = AlphaMode.BLEND;
  material.opacity *= 1 - transmits;
  material.transmission = material.albedo;
}

const multiplied = (a: Colour, b: Colour): Colour => ({ x: a.x * Math.min(1, b.x), y: a.y * Math.min(1, b.y), z: a.z * Math.min(1, b.z) });
