import { TextureFormat } from "../../../gen/lpv/v1/blob_pb.ts";
import type { Picture } from "./parts.ts";

// What a picture is for: colours, colours with the share that is covered, or numbers such as directions.
export type Use = "colour" | "colour with alpha" | "numbers";

const MOST_ALONG = 4096;
const MOST_BYTES = (64 << 20) - 1024; // of a blob, which has more in it than texels

// A PNG, JPEG or whatever the browser reads, 8 bits a channel. Nothing converts its colours and nothing multiplies them by alpha, so
// that the bytes are those of the file.
export async function readPicture(picture: Blob, name: string, use: Use): Promise<Picture> {
  const options = { colorSpaceConversion: "none", premultiplyAlpha: "none" } as const;
  let bitmap = await createImageBitmap(picture, options).catch(() => {
    throw new Error(`${name}: this browser cannot read the picture. Convert it to PNG.`);
  });
  const { width, height } = bitmap;
  const smaller = Math.min(1, MOST_ALONG / Math.max(width, height), Math.sqrt(MOST_BYTES / (4 * width * height)));
  if (smaller < 1) {
    const along = (texels: number): number => Math.max(1, Math.floor(texels * smaller));
    bitmap = await createImageBitmap(picture, { ...options, resizeWidth: along(width), resizeHeight: along(height), resizeQuality: "high" });
  }
  const { width: wide, height: high } = bitmap;
  const rgba = bytesOf(bitmap, name);
  bitmap.close();
  return pictureOf(rgba, wide, high, use);
}

// The bytes as the use wants them: three a texel, or four where any of it is not opaque and that counts.
export function pictureOf(rgba: Uint8Array, width: number, height: number, use: Use): Picture {
  if (use === "colour with alpha" && rgba.some((value, i) => i % 4 === 3 && value < 255)) {
    return { width, height, format: TextureFormat.RGBA8_SRGB, texels: rgba };
  }
  const texels = new Uint8Array(width * height * 3);
  for (let from = 0, to = 0; to < texels.length; from += 4, to += 3) {
    texels[to] = rgba[from] ?? 0;
    texels[to + 1] = rgba[from + 1] ?? 0;
    texels[to + 2] = rgba[from + 2] ?? 0;
  }
  return { width, height, format: use === "numbers" ? TextureFormat.RGB8_LINEAR : TextureFormat.RGB8_SRGB, texels };
}

// A 2D canvas multiplies by alpha, and cannot give back what that took from the colours: it is only asked where there is no WebGL.
function bytesOf(bitmap: ImageBitmap, name: string): Uint8Array {
  const bytes = throughWebgl(bitmap) ?? throughCanvas(bitmap);
  if (!bytes) throw new Error(`${name}: this browser cannot read pictures.`);
  return bytes;
}

function throughWebgl(bitmap: ImageBitmap): Uint8Array | undefined {
  const { width, height } = bitmap;
  const gl = new OffscreenCanvas(1, 1).getContext("webgl2");
  if (!gl) return undefined;
  const texels = new Uint8Array(4 * width * height);
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA8, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
  gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, gl.getParameter(gl.TEXTURE_BINDING_2D) as WebGLTexture, 0);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, texels);
  const failed = gl.getError() !== gl.NO_ERROR;
  gl.getExtension("WEBGL_lose_context")?.loseContext(); // a page may have few contexts
  return failed ? undefined : texels;
}

function throughCanvas(bitmap: ImageBitmap): Uint8Array | undefined {
  const { width, height } = bitmap;
  const context = new OffscreenCanvas(width, height).getContext("2d", { colorSpace: "srgb" });
  if (!context) return undefined;
  context.drawImage(bitmap, 0, 0);
  return new Uint8Array(context.getImageData(0, 0, width, height).data.buffer);
}
