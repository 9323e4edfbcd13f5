import { back, rotationOf, times, turned, type Placement, type Rotation } from "./placement.ts";

export type Mode = "translate" | "rotate" | "scale";
export type Space = "world" | "local";
export type AxisName = "x" | "y" | "z";

// What handles snap to, and one press of a key: metres, degrees, and a share of the size.
export const STEP: Readonly<Record<Mode, number>> = { translate: 0.1, rotate: 15, scale: 0.1 };
const FINE = 0.1; // of a step

export interface Nudge {
  mode: Mode;
  space: Space;
  snap: boolean;
  axis: AxisName;
  way: 1 | -1;
  fine: boolean;
}

// One step along or about an axis. With snap places and sizes go to the next multiple of the step; turns are by whole
// steps from where they began, as with the handles.
export function nudged(from: Placement, { mode, space, snap, axis, way, fine }: Nudge): Placement {
  const step = STEP[mode] * (fine ? FINE : 1);
  if (mode === "translate") {
    const axes: Rotation = space === "local" ? from.rotation : { x: 0, y: 0, z: 0, w: 1 };
    const along = turned(from.translation, back(axes));
    const at = snap ? next(along[axis], step, way) : along[axis] + way * step;
    return { ...from, translation: turned({ ...along, [axis]: at }, axes) };
  }
  if (mode === "rotate") {
    const turn = rotationOf({ x: 0, y: 0, z: 0, [axis]: way * step });
    return { ...from, rotation: space === "local" ? times(from.rotation, turn) : times(turn, from.rotation) };
  }
  const size = Math.abs(from.scale[axis]);
  const grown = snap ? Math.max(Math.min(size, step), next(size, step, way)) : size * (1 + step) ** way;
  return { ...from, scale: { ...from.scale, [axis]: grown * (from.scale[axis] < 0 ? -1 : 1) } };
}

// The multiple of the step after or before a value; one that the value has up to a thousandth of a step is its own.
function next(value: number, step: number, way: 1 | -1): number {
  const steps = value / step;
  const whole = way > 0 ? Math.floor(steps + 1e-3) + 1 : Math.ceil(steps - 1e-3) - 1;
  return Number((whole * step).toFixed(6));
}
