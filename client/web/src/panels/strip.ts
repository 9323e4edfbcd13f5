import { el } from "../dom.ts";
import type { ShownFrame } from "../view/frames.ts";

// Rate, latency, bytes and revision of what is shown, over the last two seconds.
export class Strip {
  readonly element = el("footer", { class: "strip", "aria-label": "Measurements" });
  private readonly shown: { at: number; bytes: number; cameraMs: number | undefined; editMs: number | undefined }[] = [];
  private readonly edits: { revision: bigint; at: number }[] = [];
  private last: ShownFrame | undefined;

  edited(revision: bigint, began: number): void {
    this.edits.push({ revision, at: began });
    if (this.edits.length > 100) this.edits.shift();
  }

  frame(frame: ShownFrame): void {
    const now = performance.now();
    let editMs: number | undefined;
    while (this.edits[0] && this.edits[0].revision <= frame.revision) editMs = now - (this.edits.shift()?.at ?? now);
    this.shown.push({ at: now, bytes: frame.bytes, cameraMs: frame.cameraMs, editMs });
    this.last = frame;
  }

  draw(sceneRevision: bigint, people: number): void {
    const from = performance.now() - 2000;
    while (this.shown[0] && this.shown[0].at < from) this.shown.shift();
    const bytes = this.shown.reduce((sum, one) => sum + one.bytes, 0);
    const middle = (values: (number | undefined)[]): string => {
      const known = values.filter((value) => value !== undefined).sort((a, b) => a - b);
      const value = known[known.length >> 1];
      return value === undefined ? "-" : `${value.toFixed(0)} ms`;
    };
    const header = this.last?.header;
    this.element.replaceChildren(
      item("Frames", `${(this.shown.length / 2).toFixed(1)}/s`),
      item("Camera to picture", middle(this.shown.map((one) => one.cameraMs))),
      item("Edit to picture", middle(this.shown.map((one) => one.editMs))),
      item("Received", `${(bytes / 2000).toFixed(0)} KB/s`),
      item("Picture", header ? `${header.width} x ${header.height}, JPEG ${header.quality}` : "-"),
      item("Revision", `${this.last?.revision ?? "-"} shown, ${sceneRevision} in the scene`),
      item("Others", String(people)),
    );
  }
}

function item(name: string, value: string): HTMLElement {
  return el("span", {}, `${name} `, el("b", {}, value));
}
