import { TextureFormat } from "../../../gen/lpv/v1/blob_pb.ts";
import type { Picture } from "./parts.ts";

export const HIGH_RANGE = /\.(hdr|exr)$/i;

// The loader takes 255 for 1 where Radiance, and lpvctl, take 256.
const OF_RADIANCE = 255 / 256;
// three.js cuts halves off instead of rounding: this much more leaves those that are exact as they are.
const TO_HALF = 1 + 2 ** -14;
const LARGEST_HALF = 65504;

// A picture of linear halves; texels that are negative or not finite become 0, as lpvctl has them.
export async function readHighRange(file: File): Promise<Picture> {
  const bytes = await file.arrayBuffer();
  const { DataUtils, FloatType } = await import("three");
  const isExr = /\.exr$/i.test(file.name);
  const read = async () => {
    if (!isExr) return new (await import("three/examples/jsm/loaders/HDRLoader.js")).HDRLoader().setDataType(FloatType).parse(bytes);
    return new (await import("three/examples/jsm/loaders/EXRLoader.js")).EXRLoader().setDataType(FloatType).parse(bytes);
  };
  const { width, height, data } = await read().catch(() => {
    throw new Error(`${file.name}: this is no picture that the page can read. Convert it to PNG.`);
  });
  if (!width || !height || !data) throw new Error(`${file.name}: the picture is empty.`);
  const channels = data.length / (width * height);
  const texels = new DataView(new ArrayBuffer(width * height * 6));
  for (let y = 0; y < height; ++y) {
    const row = (isExr ? height - 1 - y : y) * width; // rows of EXR begin at the bottom
    for (let x = 0; x < width; ++x) {
      for (let c = 0; c < 3; ++c) {
        const value = Number(data[(row + x) * channels + Math.min(c, channels - 1)]) * (isExr ? 1 : OF_RADIANCE);
        const kept = Number.isFinite(value) && value > 0 ? Math.min(value * TO_HALF, LARGEST_HALF) : 0;
        texels.setUint16(6 * (y * width + x) + 2 * c, DataUtils.toHalfFloat(kept), true);
      }
    }
  }
  return { width, height, format: TextureFormat.RGB16F, texels: new Uint8Array(texels.buffer) };
}
