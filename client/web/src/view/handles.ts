import { el } from "../dom.ts";
import type { Drawings } from "../drawings.ts";
import type { Mode, Space } from "../scene/nudge.ts";
import type { Placement } from "../scene/placement.ts";
import type { View } from "./camera_rig.ts";
import type { Gizmo } from "./gizmo.ts";
import { HandleKeys } from "./handle_keys.ts";

export interface HandlesReports {
  dragging(on: boolean): void;
  moved(to: Placement): Promise<unknown>; // until the server has it, or has refused it
  without(message: string): void; // nothing to drag by the pointer
}

// What moves, turns and scales the selected object, by pointer and by keys. There for those who may edit.
export class Handles {
  readonly canvas = el("canvas", { class: "handles", "aria-hidden": "true", hidden: true });
  readonly keys: HandleKeys;
  private gizmo: Gizmo | undefined;
  private usable = false;
  private held: [Placement | undefined, string] = [undefined, ""]; // as the scene has it
  private seen: [View, number, number] | undefined;

  constructor(private readonly pointer: HTMLElement, private readonly drawings: Drawings, private readonly reports: HandlesReports) {
    this.keys = new HandleKeys({
      dragging: (on) => reports.dragging(on),
      moved: (to) => {
        this.gizmo?.attach(to);
        return reports.moved(to);
      },
      settled: () => this.hold(...this.held),
    });
  }

  async load(): Promise<void> {
    this.usable = true;
    try {
      const { Gizmo } = await import("./gizmo.ts");
      this.gizmo = new Gizmo(this.canvas, this.pointer, this.drawings, (to) => void this.reports.moved(to), (on) => this.reports.dragging(on));
      if (this.seen) this.gizmo.setView(...this.seen);
    } catch {
      this.reports.without("This browser has no WebGL2: objects are moved by keys and numbers only.");
    }
  }

  // Whether the pointer is over a handle or drags one.
  get busy(): boolean {
    return this.gizmo?.busy ?? false;
  }

  // The focus goes to them, so that the arrows are theirs.
  take(mode: Mode): void {
    this.keys.finish();
    this.keys.mode = mode;
    this.gizmo?.setMode(mode);
    this.keys.say();
    this.keys.focus();
  }

  setSpace(space: Space): void {
    this.keys.space = space;
    this.gizmo?.setSpace(space);
    this.keys.say();
  }

  setSnap(on: boolean): void {
    this.keys.snap = on;
    this.gizmo?.setSnap(on);
  }

  hold(placement: Placement | undefined, name: string): void {
    this.held = [placement, name];
    if (!this.usable) return;
    this.keys.hold(placement, name);
    if (!this.keys.busy) this.gizmo?.attach(placement);
  }

  setView(view: View, width: number, height: number): void {
    this.seen = [view, width, height];
    this.gizmo?.setView(view, width, height);
  }
}
