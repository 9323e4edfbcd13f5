import type { VolumeHeader, VolumePart } from "../../gen/lpv/v1/volume_pb.ts";

const BRICK = 8;
const COLOURS = 3;
const COEFFICIENTS = 4;

// A volume as textures take it: for each colour the four coefficients of every cell, x fastest, as half floats; layers
// lie above one another along z. Guard cells beyond the grid's bounds are part of it.
export class Field {
  readonly dims: [number, number, number];
  readonly origin: [number, number, number];
  readonly cellSize: number;
  readonly guard: number;
  readonly scales: number[];
  readonly groups: string[];
  readonly colours: [Uint16Array, Uint16Array, Uint16Array];

  // `header`: of the newest result that was taken, a whole one here.
  constructor(public header: VolumeHeader) {
    const { grid, guardCells: guard } = header;
    const size = grid?.cellSize ?? 1;
    this.guard = guard;
    this.cellSize = size;
    this.dims = [(grid?.dims?.x ?? 0) + 2 * guard, (grid?.dims?.y ?? 0) + 2 * guard, (grid?.dims?.z ?? 0) + 2 * guard];
    this.origin = [(grid?.origin?.x ?? 0) - guard * size, (grid?.origin?.y ?? 0) - guard * size, (grid?.origin?.z ?? 0) - guard * size];
    this.scales = header.layers.map((layer) => layer.scale);
    this.groups = header.layers.map((layer) => layer.group);
    const halves = this.dims[0] * this.dims[1] * this.dims[2] * this.layers * COEFFICIENTS;
    this.colours = [new Uint16Array(halves), new Uint16Array(halves), new Uint16Array(halves)];
  }

  get layers(): number {
    return this.scales.length;
  }

  // Bricks of an uncompressed part of HALF_FLOAT: for each brick, layer, cell and colour its coefficients.
  take(part: VolumePart): void {
    const { payload } = part;
    const view = new DataView(payload.buffer, payload.byteOffset, payload.byteLength);
    let at = 0;
    for (const run of part.bricks) {
      for (let i = 0; i < run.count; ++i) at = this.takeBrick(run.first + i, view, at);
    }
  }

  private takeBrick(number: number, view: DataView, from: number): number {
    const [nx, ny, nz] = this.dims;
    const bx = Math.ceil(nx / BRICK);
    const by = Math.ceil(ny / BRICK);
    const x0 = (number % bx) * BRICK;
    const y0 = (Math.floor(number / bx) % by) * BRICK;
    const z0 = Math.floor(number / (bx * by)) * BRICK;
    const x1 = Math.min(nx, x0 + BRICK);
    const y1 = Math.min(ny, y0 + BRICK);
    const z1 = Math.min(nz, z0 + BRICK);
    let at = from;
    for (let layer = 0; layer < this.layers; ++layer) {
      for (let z = z0; z < z1; ++z) {
        for (let y = y0; y < y1; ++y) {
          let to = (((layer * nz + z) * ny + y) * nx + x0) * COEFFICIENTS;
          for (let x = x0; x < x1; ++x, to += COEFFICIENTS) {
            for (let colour = 0; colour < COLOURS; ++colour) {
              const out = this.colours[colour as 0 | 1 | 2];
              for (let k = 0; k < COEFFICIENTS; ++k, at += 2) out[to + k] = view.getUint16(at, true);
            }
          }
        }
      }
    }
    return at;
  }
}
