import type { ClientIdentity } from "../../gen/lpv/v1/session_pb.ts";
import type { Light } from "../../gen/lpv/v1/scene_pb.ts";
import type { Connection } from "../net/connection.ts";
import type { SceneModel } from "../scene/model.ts";
import type { View } from "../view/camera_rig.ts";
import type { Field } from "./field.ts";
import { Meshes } from "./meshes.ts";
import { LocalRenderer, type Measured } from "./renderer.ts";
import { VolumeFollower } from "./volumes.ts";

const METER_MS = 300;
const LONGEST_BLEND_MS = 500;
const LOST = "This browser has lost its graphics context; the picture comes back with the next one.";
const LOST_MS = 10_000; // after which a browser that has not given another context is not expected to

export interface LocalReports {
  volume(field: Field, bytes: number): void;
  drew(): void;
  trouble(message: string): void; // empty: none any more
  cannot(message: string): void; // the server's pictures have to take over
}

export interface LocalOptions {
  canvas: HTMLCanvasElement;
  connection: Connection;
  session: string;
  model: SceneModel;
  identity(): ClientIdentity | undefined;
  areaOf(light: Light): number | undefined;
  view(): View;
  size(): { width: number; height: number };
  reports: LocalReports;
}

// The room as this browser shades it: the view is drawn as often as the screen is, light comes at its own pace and is
// blended over the time between two volumes. When the link is lost the last light stays.
export class LocalView {
  readonly renderer: LocalRenderer;
  private readonly meshes: Meshes;
  private readonly follower: VolumeFollower;
  private readonly forget: () => void;
  private frame = 0;
  private changed = true;
  private sceneChanged = true;
  private ev: number | undefined; // undefined: automatic
  private metered = -Infinity; // when
  private unmetered = true; // what is seen has changed since
  private arrived = -Infinity;
  private interval = 0; // between two volumes, ms
  private lostFor: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly options: LocalOptions) {
    this.renderer = new LocalRenderer(options.canvas, (light) => options.areaOf(light));
    const scene = (): void => {
      this.sceneChanged = true;
    };
    this.meshes = new Meshes(options.connection, options.session, scene);
    this.forget = options.model.onChange(scene);
    this.follower = new VolumeFollower(options.connection, options.session, options.identity, {
      volume: (field, bytes) => this.take(field, bytes),
      trouble: (message) => options.reports.trouble(message || (this.lostFor === undefined ? "" : LOST)),
    });
    options.canvas.addEventListener("webglcontextlost", this.lost);
    options.canvas.addEventListener("webglcontextrestored", this.restored);
    this.frame = requestAnimationFrame(this.tick);
  }

  close(): void {
    clearTimeout(this.lostFor);
    this.options.canvas.removeEventListener("webglcontextlost", this.lost);
    this.options.canvas.removeEventListener("webglcontextrestored", this.restored);
    cancelAnimationFrame(this.frame);
    this.forget();
    this.follower.close();
    this.renderer.dispose();
  }

  // For tests: what the newest volume gives.
  measured(view: View, width: number, height: number, exact: boolean): Measured {
    this.renderer.setBlend(1);
    return this.renderer.measure(view, width, height, exact);
  }

  // Now: what WebGL has drawn can be read until the browser shows it.
  redraw(): void {
    const { width, height } = this.options.size();
    this.renderer.draw(this.options.view(), width, height);
  }

  cameraMoved(): void {
    this.changed = true;
  }

  setExposure(ev: number | undefined): void {
    this.ev = ev;
    this.metered = -Infinity;
    this.changed = true;
  }

  private readonly lost = (): void => {
    const { reports } = this.options;
    reports.trouble(LOST);
    this.lostFor = setTimeout(() => reports.cannot("This browser has lost its graphics context and gives no other."), LOST_MS);
  };

  // What was on the GPU is there again with the next drawing, which nothing else may ask for.
  private readonly restored = (): void => {
    clearTimeout(this.lostFor);
    this.lostFor = undefined;
    this.options.reports.trouble("");
    this.metered = -Infinity;
    this.changed = true;
  };

  private take(field: Field, bytes: number): void {
    const refused = this.renderer.setField(field);
    if (refused) return this.options.reports.cannot(refused);
    const now = performance.now();
    const since = now - this.arrived;
    this.interval = since < LONGEST_BLEND_MS ? (this.interval ? 0.7 * this.interval + 0.3 * since : since) : 0;
    if (this.interval === 0) this.renderer.setBlend(1);
    this.arrived = now;
    this.changed = true;
    this.options.reports.volume(field, bytes);
  }

  private readonly tick = (now: number): void => {
    this.frame = requestAnimationFrame(this.tick);
    if (this.sceneChanged) {
      this.sceneChanged = false;
      this.changed = true;
      const { model } = this.options;
      this.renderer.setObjects(model, this.meshes);
      this.meshes.keep(new Set([...model.surfaces.values(), ...model.lights.values()].map(({ mesh }) => mesh)));
    }
    const blending = this.interval > 0 && now - this.arrived < 1.5 * this.interval;
    // The last change counts, too, where nothing follows it: meshes come one by one.
    this.unmetered ||= this.changed || blending;
    const meters = this.ev === undefined && this.unmetered && now - this.metered > METER_MS;
    if (!this.changed && !blending && !meters) return;
    if (this.interval > 0) this.renderer.setBlend(Math.min(1, Math.max(0, (now - this.arrived) / this.interval)));
    this.changed = false;
    const { width, height } = this.options.size();
    const view = this.options.view();
    if (this.ev !== undefined) this.renderer.setExposure(this.ev);
    else if (meters) {
      this.metered = now;
      this.unmetered = false;
      const stops = this.renderer.metered(view, width / height);
      if (stops !== undefined) this.renderer.setExposure(stops);
    }
    this.renderer.draw(view, width, height);
    this.options.reports.drew();
  };
}
