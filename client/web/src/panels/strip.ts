import { el } from "../dom.ts";
import type { ShownFrame } from "../view/frames.ts";

// Rate, latency, bytes and revision of what is shown, over the last two seconds.
export class Strip {
  readonly element = el("footer", { class: "strip", "aria-label": "Measurements" });
  private readonly shown: { at: number; bytes: number; cameraMs: number | undefined; editMs: number | undefined }[] = [];
  private readonly edits: { revision: bigint; at: number }[] = [];
  private last: ShownFrame | undefined;
  private readonly drawn: number[] = []; // when, local shading
  private readonly volumes: { at: number; bytes: number; editMs: number | undefined }[] = [];
  private volumeRevision: bigint | undefined;

  edited(revision: bigint, began: number): void {
    this.edits.push({ revision, at: began });
    if (this.edits.length > 100) this.edits.shift();
  }

  frame(frame: ShownFrame): void {
    const now = performance.now();
    const editMs = this.editsUntil(frame.revision, now);
    this.shown.push({ at: now, bytes: frame.bytes, cameraMs: frame.cameraMs, editMs });
    this.last = frame;
  }

  // Local shading: the view was drawn once more.
  drew(): void {
    this.drawn.push(performance.now());
  }

  volume(revision: bigint, bytes: number): void {
    const now = performance.now();
    this.volumes.push({ at: now, bytes, editMs: this.editsUntil(revision, now) });
    this.volumeRevision = revision;
  }

  private editsUntil(revision: bigint, now: number): number | undefined {
    let took: number | undefined;
    while (this.edits[0] && this.edits[0].revision <= revision) took = now - (this.edits.shift()?.at ?? now);
    return took;
  }

  private drawLocal(sceneRevision: bigint, people: number, from: number): void {
    while (this.volumes[0] && this.volumes[0].at < from) this.volumes.shift();
    const bytes = this.volumes.reduce((sum, one) => sum + one.bytes, 0);
    this.element.replaceChildren(
      item("Drawn here", `${(this.drawn.length / 2).toFixed(1)}/s`),
      item("Volumes", `${(this.volumes.length / 2).toFixed(1)}/s`),
      item("Edit to volume", middle(this.volumes.map((one) => one.editMs))),
      item("Received", `${(bytes / 2000).toFixed(0)} KB/s`),
      item("Revision", `${this.volumeRevision ?? "-"} shown, ${sceneRevision} in the scene`),
      item("Others", String(people)),
      item("Left out", "bounces, textures, gloss, panes, haze before the camera, light finer than a cell"),
    );
  }

  draw(sceneRevision: bigint, people: number, local: boolean): void {
    const from = performance.now() - 2000;
    while (this.drawn[0] !== undefined && this.drawn[0] < from) this.drawn.shift();
    if (local) return this.drawLocal(sceneRevision, people, from);
    while (this.shown[0] && this.shown[0].at < from) this.shown.shift();
    const bytes = this.shown.reduce((sum, one) => sum + one.bytes, 0);
    const header = this.last?.header;
    this.element.replaceChildren(
      item("Frames", `${(this.shown.length / 2).toFixed(1)}/s`),
      item("Camera to picture", middle(this.shown.map((one) => one.cameraMs))),
      item("Edit to picture", middle(this.shown.map((one) => one.editMs))),
      item("Received", `${(bytes / 2000).toFixed(0)} KB/s`),
      item("Picture", header ? `${header.width} x ${header.height}, JPEG ${header.quality}${header.sharp ? ", sharp" : ""}` : "-"),
      item("Revision", `${this.last?.revision ?? "-"} shown, ${sceneRevision} in the scene`),
      item("Others", String(people)),
    );
  }
}

function middle(values: (number | undefined)[]): string {
  const known = values.filter((value) => value !== undefined).sort((a, b) => a - b);
  const value = known[known.length >> 1];
  return value === undefined ? "-" : `${value.toFixed(0)} ms`;
}

function item(name: string, value: string): HTMLElement {
  return el("span", {}, `${name} `, el("b", {}, value));
}
