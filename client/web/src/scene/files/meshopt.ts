// What EXT_meshopt_compression packs: the bitstreams of its Appendix A, of version 0 (attributes) and 1 (indices).
export interface Packed {
  bytes: Uint8Array;
  count: number;
  stride: number; // bytes of an unpacked element
  mode: string;
  filter: string;
}

const MOST_BYTES = 2 ** 30;
const GROUP = 16; // elements whose bytes are packed in one way

export function decodeMeshopt(packed: Packed): Uint8Array<ArrayBuffer> {
  const { count, stride, mode, filter } = packed;
  if (!isAllowed(packed)) {
    throw new Error(`has the mode ${mode}, the filter ${filter} and ${count} elements of ${stride} bytes, which EXT_meshopt_compression does not allow together.`);
  }
  const out = new Uint8Array(count * stride);
  const source = new Source(packed.bytes);
  if (mode === "ATTRIBUTES") {
    decodeAttributes(source, count, stride, out);
    FILTERS[filter]?.(out, stride);
    return out;
  }
  const indices = mode === "TRIANGLES" ? decodeTriangles(source, count) : decodeIndices(source, count);
  out.set(new Uint8Array((stride === 2 ? Uint16Array.from(indices) : indices).buffer));
  return out;
}

function isAllowed({ count, stride, mode, filter }: Packed): boolean {
  if (!(stride > 0 && stride <= 256 && Number.isInteger(count) && count >= 0 && count * stride <= MOST_BYTES)) return false;
  if (mode === "ATTRIBUTES") {
    if (filter === "OCTAHEDRAL") return stride === 4 || stride === 8;
    if (filter === "QUATERNION") return stride === 8;
    return stride % 4 === 0 && (filter === "NONE" || filter === "EXPONENTIAL");
  }
  if (filter !== "NONE" || (stride !== 2 && stride !== 4)) return false;
  return mode === "INDICES" || (mode === "TRIANGLES" && count % 3 === 0);
}

const damaged = (): Error => new Error("is damaged: its bytes are not what EXT_meshopt_compression writes; export the file again.");

class Source {
  at = 0;

  constructor(readonly bytes: Uint8Array) {}

  byte(): number {
    const value = this.bytes[this.at++];
    if (value === undefined) throw damaged();
    return value;
  }

  // 7 bits a byte, the lowest first.
  varint(): number {
    let value = 0;
    for (let shift = 0; shift < 35; shift += 7) {
      const byte = this.byte();
      value |= (byte & 127) << shift;
      if (byte < 128) return value >>> 0;
    }
    throw damaged();
  }

  header(wanted: number): void {
    if (this.byte() !== wanted) throw damaged();
  }

  endsBefore(tail: number): void {
    if (this.bytes.length - this.at !== tail) throw damaged();
  }
}

const signed = (value: number): number => (value >>> 1) ^ -(value & 1); // zigzag

// Each byte of the elements is packed alone, block by block, as differences from the element before. The first element's
// are from what the stream ends with.
function decodeAttributes(source: Source, count: number, stride: number, out: Uint8Array): void {
  source.header(0xa0);
  const { bytes } = source;
  if (bytes.length < 1 + stride) throw damaged();
  const last = bytes.slice(bytes.length - stride);
  const block = Math.min(256, Math.floor(8192 / stride) & ~(GROUP - 1));
  const differences = new Uint8Array(block);
  for (let first = 0; first < count; first += block) {
    const size = Math.min(block, count - first);
    for (let k = 0; k < stride; ++k) {
      decodeBytes(source, Math.ceil(size / GROUP), differences);
      for (let i = 0; i < size; ++i) out[(first + i) * stride + k] = last[k] = last[k]! + signed(differences[i]!);
    }
  }
  source.endsBefore(Math.max(32, stride));
}

// Groups of 16 bytes, each all 0, or of 2 or 4 bits where the largest says that a whole byte follows, or of 8.
function decodeBytes(source: Source, groups: number, out: Uint8Array): void {
  const modes = Array.from({ length: Math.ceil(groups / 4) }, () => source.byte());
  for (let group = 0; group < groups; ++group) {
    const bits = [0, 2, 4, 8][(modes[group >> 2]! >> (2 * (group & 3))) & 3]!;
    const from = source.at;
    source.at += 2 * bits;
    for (let i = 0; i < GROUP; ++i) {
      if (bits === 0 || bits === 8) {
        out[group * GROUP + i] = bits === 0 ? 0 : byteAt(source.bytes, from + i);
        continue;
      }
      const start = i * bits;
      const value = (byteAt(source.bytes, from + (start >> 3)) >> (8 - bits - (start & 7))) & ((1 << bits) - 1);
      out[group * GROUP + i] = value === (1 << bits) - 1 ? source.byte() : value;
    }
  }
}

function byteAt(bytes: Uint8Array, at: number): number {
  const value = bytes[at];
  if (value === undefined) throw damaged();
  return value;
}

// The last 16 that were put in; 0 is the newest.
class Recent<T> {
  private readonly items: T[] = [];
  private at = 0;

  put(item: T): void {
    this.items[this.at++ & 15] = item;
  }

  get(age: number): T {
    const item = this.items[(this.at - 1 - age) & 15];
    if (item === undefined) throw damaged();
    return item;
  }
}

// Triangles as an edge of an earlier one with a corner of its own, or as three corners; corners are new (the next
// number), recent, or differ by so much from the last that was said.
function decodeTriangles(source: Source, count: number): Uint32Array {
  source.header(0xe1);
  const { bytes } = source;
  const codes = source.at;
  const end = bytes.length - 16;
  source.at += count / 3;
  const edges = new Recent<[number, number]>();
  const recent = new Recent<number>();
  const out = new Uint32Array(count);
  let next = 0;
  let last = 0;
  const said = (): number => (last = (last + signed(source.varint())) >>> 0);
  const corner = (code: number, older: number): number => {
    if (code === 15) return said();
    return code === 0 ? next++ : recent.get(code - older);
  };
  for (let i = 0; i < count; i += 3) {
    const code = byteAt(bytes, codes + i / 3);
    const [high, low] = [code >> 4, code & 15];
    let [a, b, c] = [0, 0, 0];
    if (high < 15) {
      [a, b] = edges.get(high);
      if (low === 13 || low === 14) c = last = (last + (low === 13 ? -1 : 1)) >>> 0;
      else c = corner(low, 0);
      if (low === 0 || low > 12) recent.put(c);
    } else {
      const more = low < 14 ? byteAt(bytes, end + low) : source.byte();
      if (low >= 14 && more === 0) next = 0;
      const [second, third] = [more >> 4, more & 15];
      a = low === 15 ? NaN : next++;
      // What is new comes first, what is said after it.
      b = second === 15 ? NaN : corner(second, 1);
      c = third === 15 ? NaN : corner(third, 1);
      if (Number.isNaN(a)) a = said();
      if (Number.isNaN(b)) b = said();
      if (Number.isNaN(c)) c = said();
      recent.put(a);
      if (second === 0 || second === 15) recent.put(b);
      if (third === 0 || third === 15) recent.put(c);
      edges.put([b, a]);
    }
    edges.put([c, b]);
    edges.put([a, c]);
    out.set([a, b, c], i);
  }
  source.endsBefore(16);
  return out;
}

// Differences from one of two earlier ones.
function decodeIndices(source: Source, count: number): Uint32Array {
  source.header(0xd1);
  const last = [0, 0];
  const out = Uint32Array.from({ length: count }, () => {
    const value = source.varint();
    const which = value & 1;
    return (last[which] = (last[which]! + signed(value >>> 1)) >>> 0);
  });
  source.endsBefore(4);
  return out;
}

const rounded = (value: number): number => Math.trunc(value + (value >= 0 ? 0.5 : -0.5));

// What unpacked numbers still stand for, in place.
const FILTERS: Record<string, (bytes: Uint8Array, stride: number) => void> = {
  // Unit vectors as points of an octahedron's unfolded faces.
  OCTAHEDRAL(bytes, stride) {
    const values = stride === 4 ? new Int8Array(bytes.buffer) : new Int16Array(bytes.buffer);
    const largest = stride === 4 ? 127 : 32767;
    for (let i = 0; i < values.length; i += 4) {
      let [x, y] = [values[i]!, values[i + 1]!];
      const z = values[i + 2]! - Math.abs(x) - Math.abs(y);
      const fold = Math.min(z, 0);
      x += x >= 0 ? fold : -fold;
      y += y >= 0 ? fold : -fold;
      const scale = largest / Math.hypot(x, y, z);
      [x, y, z].forEach((value, c) => (values[i + c] = rounded(value * scale)));
    }
  },
  // Three of a quaternion's numbers, and which is the fourth.
  QUATERNION(bytes) {
    const values = new Int16Array(bytes.buffer);
    for (let i = 0; i < values.length; i += 4) {
      const scale = Math.SQRT1_2 / (values[i + 3]! | 3);
      const largest = values[i + 3]! & 3;
      const three = [0, 1, 2].map((c) => values[i + c]! * scale);
      const fourth = Math.sqrt(Math.max(0, 1 - three.reduce((sum, value) => sum + value * value, 0)));
      [fourth, ...three].forEach((value, c) => (values[i + ((largest + c) & 3)] = rounded(value * 32767)));
    }
  },
  // 24 bits of a number and 8 of its power of 2.
  EXPONENTIAL(bytes) {
    const packed = new Int32Array(bytes.buffer);
    const floats = new Float32Array(bytes.buffer);
    packed.forEach((value, i) => (floats[i] = ((value << 8) >> 8) * 2 ** (value >> 24)));
  },
};
