import type { Light } from "../../gen/lpv/v1/scene_pb.ts";

// Linear Rec.709.
export interface Colour {
  x: number;
  y: number;
  z: number;
}

export const LUMENS_PER_WATT = 179;

// W/(sr m^2), of a light whose sides emit from `area` m^2 in all.
export function radianceOf(light: Light, area: number): Colour {
  if (light.emission.case === "radiance") return light.emission.value;
  if (light.emission.case === "power") {
    const perWatt = 1 / (Math.PI * area);
    return scaled(light.emission.value, Number.isFinite(perWatt) ? perWatt : 0);
  }
  return { x: 1, y: 1, z: 1 };
}

// Area of all emitting sides, m^2.
export function emittingArea(light: Light, oneSide: number): number {
  return oneSide * (light.twoSided ? 2 : 1);
}

export const scaled = (colour: Colour, by: number): Colour => ({ x: colour.x * by, y: colour.y * by, z: colour.z * by });
export const strongest = (colour: Colour): number => Math.max(colour.x, colour.y, colour.z);
export const luminance = (colour: Colour): number => 0.2126 * colour.x + 0.7152 * colour.y + 0.0722 * colour.z;

// All three colours together, W.
export function watts(radiance: Colour, area: number): number {
  return Math.PI * area * (radiance.x + radiance.y + radiance.z);
}

// Luminous flux, lm.
export function lumens(radiance: Colour, area: number): number {
  return LUMENS_PER_WATT * Math.PI * area * luminance(radiance);
}

// Of a black body at that many kelvins, the strongest of the three made 1: the Planckian locus in CIE 1931 xy by Kim et
// al. (US patent 7024034, 2006), cubics for 1,667 to 25,000 K, .0005 off at 2,856; what Rec.709 cannot show is cut at 0.
export const COLDEST = 1667, HOTTEST = 25000;
export function fromKelvins(kelvins: number): Colour {
  const t = 1e3 / Math.min(HOTTEST, Math.max(COLDEST, kelvins));
  const x = t > 0.25
    ? ((-0.2661239 * t - 0.234358) * t + 0.8776956) * t + 0.17991
    : ((-3.0258469 * t + 2.1070379) * t + 0.2226347) * t + 0.24039;
  const y = t > 1 / 2.222
    ? ((-1.1063814 * x - 1.3481102) * x + 2.18555832) * x - 0.20219683
    : t > 0.25
      ? ((-0.9549476 * x - 1.37418593) * x + 2.09137015) * x - 0.16748867
      : ((3.081758 * x - 5.8733867) * x + 3.75112997) * x - 0.37001483;
  const X = x / y, Z = (1 - x - y) / y;
  const colour = {
    x: Math.max(0, 3.2404542 * X - 1.5371385 - 0.4985314 * Z),
    y: Math.max(0, -0.969266 * X + 1.8760108 + 0.041556 * Z),
    z: Math.max(0, 0.0556434 * X - 0.2040259 + 1.0572252 * Z),
  };
  return scaled(colour, 1 / strongest(colour));
}

// The temperature whose colour this is, to a percent; undefined where it is not that of a black body.
export function toKelvins(colour: Colour): number | undefined {
  const full = strongest(colour);
  if (full <= 0) return undefined;
  const hue = scaled(colour, 1 / full);
  const off = (kelvins: number): number => {
    const body = fromKelvins(kelvins);
    return Math.max(Math.abs(body.x - hue.x), Math.abs(body.y - hue.y), Math.abs(body.z - hue.z));
  };
  let best = COLDEST;
  for (let kelvins = COLDEST; kelvins < HOTTEST; kelvins *= 1.005) if (off(kelvins) < off(best)) best = kelvins;
  return off(best) < 0.02 ? best : undefined;
}

const coded = (linear: number): number => (linear <= 0.0031308 ? 12.92 * linear : 1.055 * linear ** (1 / 2.4) - 0.055);
const decoded = (value: number): number => (value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);

// The hue as a colour picker has it: sRGB, the strongest of the three at its full value.
export function toHex(colour: Colour): string {
  const full = strongest(colour) || 1;
  const byte = (value: number): string =>
    Math.round(255 * coded(Math.min(1, Math.max(0, value / full)))).toString(16).padStart(2, "0");
  return `#${byte(colour.x)}${byte(colour.y)}${byte(colour.z)}`;
}

// Of "#rrggbb", the strongest of the three made 1 unless all are 0.
export function fromHex(hex: string): Colour {
  const at = (i: number): number => decoded(parseInt(hex.slice(i, i + 2), 16) / 255);
  const colour = { x: at(1), y: at(3), z: at(5) };
  const full = strongest(colour);
  return full > 0 ? scaled(colour, 1 / full) : colour;
}

export function plainHex(colour: Colour): string {
  const byte = (value: number): string => Math.round(255 * coded(Math.min(1, Math.max(0, value)))).toString(16).padStart(2, "0");
  return `#${byte(colour.x)}${byte(colour.y)}${byte(colour.z)}`;
}

export function plainColour(hex: string): Colour {
  const at = (i: number): number => decoded(parseInt(hex.slice(i, i + 2), 16) / 255);
  return { x: at(1), y: at(3), z: at(5) };
}
