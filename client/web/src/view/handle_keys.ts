import { el } from "../dom.ts";
import { nudged, type AxisName, type Mode, type Space } from "../scene/nudge.ts";
import { anglesOf, type Placement } from "../scene/placement.ts";

const STEPS: Readonly<Record<string, readonly [AxisName, 1 | -1]>> = {
  ArrowRight: ["x", 1], ArrowLeft: ["x", -1], PageUp: ["y", 1], PageDown: ["y", -1], ArrowDown: ["z", 1], ArrowUp: ["z", -1],
};
const VERBS: Readonly<Record<Mode, string>> = { translate: "Move", rotate: "Turn", scale: "Scale" };

export interface HandleKeysReports {
  dragging(on: boolean): void;
  moved(to: Placement): Promise<unknown>; // until the server has it, or has refused it
  settled(): void;
}

// The handles of who has no pointer: what has the focus while the arrows move, turn or scale what is selected. Steps in
// quick succession are one drag, which is one undo step.
export class HandleKeys {
  private readonly words = el("p", { id: "handle-keys-words" });
  private readonly result = el("p", { role: "status" });
  readonly element = el("div", { class: "handle-keys", id: "handle-keys", tabindex: 0, role: "application", "aria-describedby": "handle-keys-words", hidden: true }, this.words, this.result);
  mode: Mode = "translate";
  space: Space = "world";
  snap = false;
  pauseMs = 700; // without a step, after which the next one is an undo step of its own
  private held: Placement | undefined;
  private name = "";
  private pause: ReturnType<typeof setTimeout> | undefined;
  private underWay = 0;

  constructor(private readonly reports: HandleKeysReports) {
    this.element.addEventListener("keydown", (event) => this.pressed(event));
    this.element.addEventListener("blur", () => this.finish());
  }

  // Steps are under way: what the server says of the object lags behind.
  get busy(): boolean {
    return this.pause !== undefined || this.underWay > 0;
  }

  hold(placement: Placement | undefined, name: string): void {
    if (this.busy && placement && name === this.name) return;
    this.finish();
    this.held = placement;
    if (name === this.name && this.element.hidden === !placement) return;
    const focused = document.activeElement === this.element;
    this.name = name;
    this.element.hidden = !placement;
    this.result.textContent = "";
    if (focused && !placement) this.element.parentElement?.focus();
    this.say();
  }

  focus(): void {
    this.element.focus();
  }

  say(): void {
    const axes = this.mode === "scale" || this.space === "local" ? "of its own" : "of the world";
    this.element.setAttribute("aria-label", `Handles of ${this.name}`);
    this.words.textContent = `${VERBS[this.mode]} ${this.name}: ← → x, Page Up and Down y, ↑ ↓ z, axes ${axes}; with Shift a tenth of a step. v: back to the picture.`;
  }

  private pressed(event: KeyboardEvent): void {
    if (event.key === "Shift") return;
    const step = STEPS[event.key];
    if (!step || !this.held || event.ctrlKey || event.metaKey || event.altKey) return this.finish();
    event.preventDefault();
    event.stopPropagation(); // the picture's arrows turn the camera
    if (this.pause === undefined) this.reports.dragging(true);
    const { mode, space, snap } = this;
    this.held = nudged(this.held, { mode, space, snap, axis: step[0], way: step[1], fine: event.shiftKey });
    clearTimeout(this.pause);
    this.pause = setTimeout(() => this.finish(), this.pauseMs);
    void this.send(this.held);
  }

  private async send(to: Placement): Promise<void> {
    this.underWay += 1;
    await this.reports.moved(to);
    this.underWay -= 1;
    if (!this.busy) this.reports.settled();
  }

  finish(): void {
    if (this.pause === undefined) return;
    clearTimeout(this.pause);
    this.pause = undefined;
    this.result.textContent = this.where();
    this.reports.dragging(false);
    if (!this.busy) this.reports.settled();
  }

  private where(): string {
    if (!this.held) return "";
    const { translation, rotation, scale } = this.held;
    const [what, { x, y, z }, unit] = this.mode === "translate" ? ["position", translation, " m"] as const
      : this.mode === "rotate" ? ["rotation", anglesOf(rotation), " degrees"] as const : ["scale", scale, ""] as const;
    const number = (value: number): string => String(Number(value.toFixed(3)));
    return `${this.name}: ${what} ${number(x)}, ${number(y)}, ${number(z)}${unit}`;
  }
}
