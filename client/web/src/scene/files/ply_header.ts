interface PlyType {
  bytes: number;
  get: (view: DataView, at: number, little: boolean) => number;
}

export interface PlyProperty {
  name: string;
  type: PlyType;
  count?: PlyType; // of a list: how its length is stored
}

export interface PlyElement {
  name: string;
  count: number;
  properties: PlyProperty[];
}

export interface PlyHeader {
  format: "ascii" | "binary_little_endian" | "binary_big_endian";
  elements: PlyElement[];
  bytes: number; // of the header
}

const INT8: PlyType = { bytes: 1, get: (view, at) => view.getInt8(at) };
const UINT8: PlyType = { bytes: 1, get: (view, at) => view.getUint8(at) };
const INT16: PlyType = { bytes: 2, get: (view, at, little) => view.getInt16(at, little) };
const UINT16: PlyType = { bytes: 2, get: (view, at, little) => view.getUint16(at, little) };
const INT32: PlyType = { bytes: 4, get: (view, at, little) => view.getInt32(at, little) };
const UINT32: PlyType = { bytes: 4, get: (view, at, little) => view.getUint32(at, little) };
const FLOAT: PlyType = { bytes: 4, get: (view, at, little) => view.getFloat32(at, little) };
const DOUBLE: PlyType = { bytes: 8, get: (view, at, little) => view.getFloat64(at, little) };
const TYPES: Record<string, PlyType> = {
  char: INT8, int8: INT8, uchar: UINT8, uint8: UINT8, short: INT16, int16: INT16, ushort: UINT16, uint16: UINT16,
  int: INT32, int32: INT32, uint: UINT32, uint32: UINT32, float: FLOAT, float32: FLOAT, double: DOUBLE, float64: DOUBLE,
};

const LONGEST = 1 << 16; // bytes of a header
const incomplete = (): Error => new Error("its PLY header is not complete, or names a format or a type that PLY does not have.");

export function readPlyHeader(bytes: Uint8Array): PlyHeader {
  const text = Array.from(bytes.subarray(0, LONGEST), (byte) => String.fromCharCode(byte)).join("");
  const end = /^end_header[ \t]*(\r\n|\r|\n)/m.exec(text);
  if (!text.startsWith("ply") || !end) throw incomplete();
  let format = "";
  const elements: PlyElement[] = [];
  for (const line of text.slice(0, end.index).split(/\r\n|\r|\n/)) {
    const [keyword, ...words] = line.trim().split(/\s+/);
    if (keyword === "format") format = words[0] ?? "";
    if (keyword === "element") elements.push({ name: words[0] ?? "", count: Number(words[1]), properties: [] });
    if (keyword === "property") elements.at(-1)?.properties.push(propertyOf(words));
  }
  if (format !== "ascii" && format !== "binary_little_endian" && format !== "binary_big_endian") throw incomplete();
  if (elements.some(({ count }) => !Number.isInteger(count) || count < 0)) throw incomplete();
  return { format, elements, bytes: end.index + end[0].length };
}

function propertyOf(words: readonly string[]): PlyProperty {
  const list = words[0] === "list";
  const type = TYPES[words[list ? 2 : 0] ?? ""];
  const count = list ? TYPES[words[1] ?? ""] : undefined;
  if (!type || (list && !count)) throw incomplete();
  return { name: words[list ? 3 : 1] ?? "", type, ...(count ? { count } : {}) };
}
