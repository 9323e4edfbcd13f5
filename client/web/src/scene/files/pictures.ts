import { bytesWithin, lastPart, type DroppedFiles } from "./dropped_files.ts";
import { HIGH_RANGE, readHighRange } from "./high_range.ts";
import type { Picture } from "./parts.ts";
import { readPicture, type Use } from "./texels.ts";

// The pictures that a file's materials name; each is read once for every use. One that cannot be read is left out, and
// `warnings` says so.
export class Pictures {
  private readonly known = new Map<string, Promise<Picture | undefined>>();

  constructor(private readonly files: DroppedFiles, private readonly of: string, private readonly warnings: string[]) {}

  named(uri: string, use: Use): Promise<Picture | undefined> {
    return this.once(`${use} ${uri}`, async () => {
      const bytes = bytesWithin(uri);
      if (bytes) return readPicture(new Blob([bytes]), `A picture in ${this.of}`, use);
      const file = this.files.find(uri);
      if (!file) throw new Error(`${this.of} names the picture ${lastPart(uri)}, which was not dropped: drop both together.`);
      return HIGH_RANGE.test(file.name) ? readHighRange(file) : readPicture(file, file.name, use);
    });
  }

  // Of bytes within the file; `key` tells them from others.
  within(key: string, bytes: Uint8Array<ArrayBuffer>, use: Use): Promise<Picture | undefined> {
    return this.once(`${use} ${key}`, () => readPicture(new Blob([bytes]), `A picture in ${this.of}`, use));
  }

  private once(key: string, read: () => Promise<Picture>): Promise<Picture | undefined> {
    const known = this.known.get(key);
    if (known) return known;
    const reading = read().catch((error: unknown) => {
      this.warnings.push(error instanceof Error ? error.message : String(error));
      return undefined;
    });
    this.known.set(key, reading);
    return reading;
  }
}

// Mean of a picture of sRGB bytes, linear.
export function meanColour({ texels, width, height }: Picture): { x: number; y: number; z: number } {
  const sums = [0, 0, 0];
  for (let i = 0; i < texels.length; ++i) sums[i % 3] = (sums[i % 3] ?? 0) + (LINEAR[texels[i] ?? 0] ?? 0);
  const [x = 0, y = 0, z = 0] = sums.map((sum) => sum / (width * height));
  return { x, y, z };
}

const LINEAR = Float64Array.from({ length: 256 }, (_, byte) => {
  const value = byte / 255;
  return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
});
