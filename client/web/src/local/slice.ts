import type { ClientIdentity } from "../../gen/lpv/v1/session_pb.ts";
import { el, labelled } from "../dom.ts";
import type { Connection } from "../net/connection.ts";
import type { Field } from "./field.ts";
import { VolumeFollower } from "./volumes.ts";

export type Axis = 0 | 1 | 2;
export type By = "fluence" | "direction";

// Of a plane of cells: pixels from top to bottom, as a person looks along the axis with up (or, along y, -z) above.
export interface Slice {
  width: number;
  height: number;
  rgba: Uint8ClampedArray<ArrayBuffer>;
  largest: number; // fluence, W/m^2
}

const DECADES = 4;
const RAMP: readonly (readonly [number, number, number])[] = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

export function fromHalf(bits: number): number {
  const sign = bits & 0x8000 ? -1 : 1;
  const exponent = (bits >> 10) & 31;
  const fraction = bits & 1023;
  if (exponent === 0) return sign * fraction * 2 ** -24;
  return sign * (exponent === 31 ? (fraction ? NaN : Infinity) : (1024 + fraction) * 2 ** (exponent - 25));
}

// Mean of the three colours of the coefficients of a cell, all layers together.
function coefficientsAt(field: Field, x: number, y: number, z: number): [number, number, number, number] {
  const [nx, ny, nz] = field.dims;
  const sum: [number, number, number, number] = [0, 0, 0, 0];
  for (let layer = 0; layer < field.layers; ++layer) {
    const at = 4 * (((layer * nz + z) * ny + y) * nx + x);
    const scale = (field.scales[layer] ?? 0) / 3;
    for (const halves of field.colours) for (let k = 0; k < 4; ++k) sum[k as 0] += scale * fromHalf(halves[at + k] ?? 0);
  }
  return sum;
}

function ramp(t: number): readonly [number, number, number] {
  const at = Math.min(1, Math.max(0, t)) * (RAMP.length - 1);
  const low = Math.min(RAMP.length - 2, Math.floor(at));
  const [a, b] = [RAMP[low], RAMP[low + 1]];
  if (!a || !b) return [0, 0, 0];
  const mixed = (i: 0 | 1 | 2): number => a[i] + (at - low) * (b[i] - a[i]);
  return [mixed(0), mixed(1), mixed(2)];
}

// `at`: the plane's cell along the axis, guard cells not counted. By fluence: decades below the largest; by direction: red,
// green and blue for x, y and z of where the light comes from, grey where it comes from all around.
export function sliceOf(field: Field, axis: Axis, at: number, by: By): Slice {
  const { guard, dims } = field;
  const [right, up] = axis === 0 ? [2, 1] : axis === 1 ? [0, 2] : [0, 1];
  const width = dims[right as Axis] - 2 * guard;
  const height = dims[up as Axis] - 2 * guard;
  const cells: [number, number, number, number][] = [];
  for (let row = 0; row < height; ++row) {
    for (let column = 0; column < width; ++column) {
      const cell: [number, number, number] = [0, 0, 0];
      cell[axis] = at + guard;
      cell[right as Axis] = column + guard;
      cell[up as Axis] = (axis === 1 ? row : height - 1 - row) + guard;
      cells.push(coefficientsAt(field, ...cell));
    }
  }
  const fluence = (one: readonly number[]): number => Math.sqrt(4 * Math.PI) * (one[0] ?? 0);
  const largest = cells.reduce((most, one) => Math.max(most, fluence(one)), 0);
  const rgba = new Uint8ClampedArray(4 * cells.length);
  cells.forEach((one, i) => {
    const decades = largest > 0 && fluence(one) > 0 ? 1 + Math.log10(fluence(one) / largest) / DECADES : 0;
    const [, y, z, x] = one; // bands 1 -1, 1 0, 1 1
    const most = Math.sqrt(3) * one[0] || 1; // of light from one direction alone
    const shown = by === "fluence" ? ramp(decades)
      : [x, y, z].map((part) => 255 * Math.max(0, decades) * (0.5 + (0.5 * part) / most));
    rgba.set([...shown, 255], 4 * i);
  });
  return { width, height, rgba, largest };
}

// A panel for people who debug light: a plane of the streamed volume's cells.
export class SliceView {
  private readonly canvas = el("canvas");
  private readonly axis = el("select", {}, el("option", { value: "1" }, "from above"), el("option", { value: "2" }, "from the front"),
    el("option", { value: "0" }, "from the side"));
  private readonly by = el("select", {}, el("option", { value: "fluence" }, "fluence"), el("option", { value: "direction" }, "direction"));
  private readonly plane = el("input", { type: "range", min: 0, max: 0, step: 1 });
  private readonly words = el("p", { class: "quiet" });
  private readonly volumes: VolumeFollower;
  private field: Field | undefined;
  private touched = false;
  readonly element: HTMLElement;

  constructor(connection: Connection, session: string, identity: () => ClientIdentity | undefined) {
    this.element = el("section", { class: "slice", "aria-label": "Slice of the volume" }, this.canvas,
      labelled("Seen", this.axis), labelled("Plane", this.plane), labelled("By", this.by), this.words);
    // Not the picture's: it would turn the camera.
    for (const kind of ["pointerdown", "pointermove", "wheel"]) this.element.addEventListener(kind, (event) => event.stopPropagation());
    this.element.addEventListener("keydown", (event) => {
      if (event.key.startsWith("Arrow")) event.stopPropagation();
    });
    this.axis.addEventListener("change", () => { this.touched = false; this.draw(); });
    this.by.addEventListener("change", () => this.draw());
    this.plane.addEventListener("input", () => { this.touched = true; this.draw(); });
    this.volumes = new VolumeFollower(connection, session, identity, {
      volume: (field) => { this.field = field; this.draw(); },
      trouble: (message) => { if (message) this.words.textContent = message; },
    });
  }

  close(): void {
    this.volumes.close();
    this.element.remove();
  }

  private draw(): void {
    const { field } = this;
    if (!field) return;
    const axis = Number(this.axis.value) as Axis;
    const planes = field.dims[axis] - 2 * field.guard;
    this.plane.max = String(planes - 1);
    if (!this.touched) this.plane.value = String(planes >> 1);
    const at = Math.min(planes - 1, Number(this.plane.value));
    const slice = sliceOf(field, axis, at, this.by.value as By);
    this.canvas.width = slice.width;
    this.canvas.height = slice.height;
    this.canvas.getContext("2d")?.putImageData(new ImageData(slice.rgba, slice.width, slice.height), 0, 0);
    const place = field.origin[axis] + (at + field.guard + 0.5) * field.cellSize;
    this.words.textContent = `${"xyz"[axis] ?? ""} = ${place.toFixed(2)} m, cell ${at + 1} of ${planes}. `
      + (this.by.value === "fluence" ? `Yellow: ${slice.largest.toPrecision(3)} W/m²; each colour further down a tenth of it.`
        : "Red, green, blue: light from +x, +y, +z; dark: from the other side; grey: from all around.");
  }
}
