import { FrameFormat, ResultService } from "../../gen/lpv/v1/result_pb.ts";
import { download, el } from "../dom.ts";
import type { Drawings } from "../drawings.ts";
import { serverStream, unary } from "../net/calls.ts";
import type { Connection } from "../net/connection.ts";
import type { Editor } from "../scene/editor.ts";
import { boxOf, type SceneModel } from "../scene/model.ts";
import type { Placement } from "../scene/placement.ts";
import { CameraRig } from "./camera_rig.ts";
import { DarkHint } from "./dark.ts";
import { FrameView, type ShownFrame } from "./frames.ts";
import type { Camera } from "../../gen/lpv/v1/geometry_pb.ts";
import type { Light } from "../../gen/lpv/v1/scene_pb.ts";
import type { Field } from "../local/field.ts";
import type { SliceView } from "../local/slice.ts";
import type { LocalView } from "../local/view.ts";
import { Handles } from "./handles.ts";
import { navigate } from "./navigate.ts";
import { Watchers } from "./watchers.ts";

// The view of a session without cameras.
const FIRST_FOV = 60; // degrees
const ROOM = 0.4; // so much of the way from its middle to its front has to be free in what is looked at from within
const MOST_PIXELS = 960 * 540; // larger windows are shown smaller pictures, enlarged

export interface StageReports {
  shown(frame: ShownFrame): void;
  volume(field: Field, bytes: number): void;
  drew(): void;
  looking(local: boolean): void;
  picked(name: string, more: boolean): void;
  cameraMoved(steered: boolean): void; // by this page, or because it follows somebody
  dragging(on: boolean): void;
  moved(to: Placement): Promise<unknown>;
  refused(error: unknown): void;
  said(message: string): void; // stays until it is closed, whatever pictures come
}

// The picture with its camera, the handles and the others' cameras over it.
export class Stage {
  readonly rig = new CameraRig();
  readonly handles: Handles;
  readonly watchers: Watchers;
  private readonly picture = el("canvas", { id: "picture", role: "img", "aria-label": "The room, as the server draws it" });
  private shaded = el("canvas", { id: "shaded", role: "img", "aria-label": "The room, as this browser shades it", hidden: true });
  private readonly dark: DarkHint;
  private readonly trouble = el("p", { class: "trouble", role: "status", hidden: true });
  readonly element = el("section", { class: "stage", tabindex: 0, id: "stage", "aria-label": "View" }, this.picture, this.shaded);
  private frames: FrameView | undefined;
  private local: LocalView | undefined;
  private slice: SliceView | undefined;
  private ev: number | undefined;
  private closed = false;
  private aimed = false;

  constructor(private readonly connection: Connection, private readonly session: string, private readonly editor: Editor,
    private readonly model: SceneModel, private readonly areaOf: (light: Light) => number | undefined, private readonly drawings: Drawings,
    private readonly reports: StageReports) {
    this.watchers = new Watchers(drawings);
    this.dark = new DarkHint(this.picture, () => [...model.lights.values()].some(({ enabled }) => enabled !== false));
    this.handles = new Handles(this.element, drawings, {
      moved: (to) => this.reports.moved(to), dragging: (on) => this.reports.dragging(on), without: (message) => this.reports.said(message),
    });
    this.element.append(this.watchers.element, this.handles.canvas, this.handles.keys.element, this.dark.element, this.trouble);
    navigate(this.element, this.rig, {
      busy: () => this.handles.busy,
      moved: () => this.cameraChanged(),
      clicked: (x, y, more) => void this.pick(x, y, more),
    });
    new ResizeObserver(() => this.resized()).observe(this.element);
  }

  // Called when the scene is known for the first time.
  async start(mayEdit: boolean): Promise<void> {
    await this.home();
    if (this.closed) return;
    this.showFrames();
    if (mayEdit) await this.handles.load();
  }

  close(): void {
    this.closed = true;
    this.dark.close();
    this.frames?.close();
    this.local?.close();
    this.slice?.close();
  }

  setExposure(ev: number | undefined): void {
    this.ev = ev;
    this.frames?.setExposure(ev);
    this.local?.setExposure(ev);
  }

  get isLocal(): boolean {
    return this.local !== undefined;
  }

  get shading(): LocalView | undefined {
    return this.local;
  }

  // A plane of the volume's cells beside the picture, or none.
  async flipSlice(): Promise<void> {
    const { SliceView } = await import("../local/slice.ts");
    if (this.closed) return;
    this.slice?.close();
    this.slice = this.slice ? undefined : new SliceView(this.connection, this.session, () => this.editor.identity);
    if (this.slice) this.element.append(this.slice.element);
  }

  // The server's pictures, or this browser's own shading of the light.
  async flipLook(): Promise<void> {
    if (this.local) return this.showFrames();
    try {
      const { LocalView } = await import("../local/view.ts");
      if (this.local || this.closed) return;
      this.local = new LocalView({
        canvas: this.freshCanvas(), connection: this.connection, session: this.session, model: this.model,
        identity: () => this.editor.identity, areaOf: this.areaOf, view: () => this.rig.view(), size: () => this.pixels(),
        reports: {
          volume: (field, bytes) => this.reports.volume(field, bytes),
          drew: () => {
            this.drawings.now();
            this.reports.drew();
          },
          trouble: (message) => this.say(message),
          cannot: (message) => {
            this.showFrames();
            this.reports.said(`${message} The server's pictures are shown.`);
          },
        },
      });
    } catch {
      return this.reports.said("This browser has no WebGL2: the server's pictures are shown.");
    }
    this.frames?.close();
    this.frames = undefined;
    this.dark.close();
    this.local.setExposure(this.ev);
    this.picture.hidden = true;
    this.say("");
    this.reports.looking(true);
  }

  private showFrames(): void {
    this.local?.close();
    this.local = undefined;
    this.shaded.hidden = true;
    this.picture.hidden = false;
    this.frames = new FrameView(this.picture, this.connection, this.session, () => this.editor.identity, () => this.rig.view(), {
      shown: (frame) => {
        this.drawings.now();
        if (frame.revision >= this.model.revision) this.dark.shown();
        this.reports.shown(frame);
      },
      trouble: (message) => this.say(message),
    });
    if (this.ev !== undefined) this.frames.setExposure(this.ev);
    const { width, height } = this.pixels();
    this.frames.start(width, height);
    this.reports.looking(false);
  }

  // A canvas whose context was given up takes no other.
  private freshCanvas(): HTMLCanvasElement {
    const fresh = this.shaded.cloneNode() as HTMLCanvasElement;
    this.shaded.replaceWith(fresh);
    this.shaded = fresh;
    fresh.hidden = false;
    return fresh;
  }

  // Objects are being moved.
  moving(): void {
    this.frames?.moving();
  }

  // The first camera of the session, else the whole grid from the front: from before it, or within a closed room, from
  // its front wall.
  async home(): Promise<void> {
    const camera = [...this.model.cameras.values()][0];
    if (camera?.eye && camera.target) {
      this.rig.set({ eye: camera.eye, target: camera.target, fovDegrees: camera.fovDegrees });
    } else {
      const box = this.model.grid && boxOf(this.model.grid);
      if (box?.min && box.max) {
        const centre = { x: (box.min.x + box.max.x) / 2, y: (box.min.y + box.max.y) / 2, z: (box.min.z + box.max.z) / 2 };
        const depth = box.max.z - centre.z;
        const { width, height } = this.pixels();
        const slope = Math.tan((FIRST_FOV * Math.PI) / 360);
        const away = Math.max((box.max.y - centre.y) / slope, (box.max.x - centre.x) / slope / (width / height));
        const wall = await this.behind(centre);
        const inRoom = wall !== undefined && wall > ROOM * depth;
        this.rig.set({ eye: { ...centre, z: centre.z + (inRoom ? 0.9 * wall : depth + away) }, target: centre, fovDegrees: FIRST_FOV });
      }
    }
    this.aimed = true;
    this.cameraChanged();
  }

  // Looks as somebody else does.
  follow({ eye, target, fovDegrees }: Camera): void {
    if (!eye || !target) return;
    const before = JSON.stringify(this.rig.view());
    this.rig.set({ eye, target, fovDegrees });
    if (JSON.stringify(this.rig.view()) !== before) this.cameraChanged(false);
  }

  frameObject(centre: Placement["translation"], radius: number): void {
    this.rig.frame(centre, radius);
    this.cameraChanged();
  }

  // Linear radiance of what is shown, as the server draws it alone: slower than a stream's picture, and finer.
  async saveLinear(): Promise<void> {
    const parts: Uint8Array<ArrayBuffer>[] = [];
    const { width, height } = this.pixels();
    const { eye, target, fovDegrees } = this.rig.view();
    for await (const { part } of serverStream(this.connection, ResultService.method.getFrame,
      { session: this.session, camera: { eye, target, fovDegrees }, width, height, format: FrameFormat.EXR })) {
      if (part) parts.push(part.payload as Uint8Array<ArrayBuffer>);
    }
    download(new Blob(parts), `${this.session.replace("sessions/", "")}.exr`);
  }

  savePicture(): void {
    if (this.local) this.local.redraw();
    (this.local ? this.shaded : this.picture).toBlob((blob) => {
      if (blob) download(blob, `${this.session.replace("sessions/", "")}.png`);
    }, "image/png");
  }

  say(message: string): void {
    this.trouble.textContent = message;
    this.trouble.hidden = message === "";
  }

  private cameraChanged(steered = true): void {
    if (!this.aimed) return;
    this.dark.moving();
    this.frames?.cameraMoved();
    this.local?.cameraMoved();
    this.lookThrough();
    this.reports.cameraMoved(steered);
  }

  private resized(): void {
    if (!this.aimed) return;
    const { width, height } = this.pixels();
    this.frames?.resize(width, height);
    this.local?.cameraMoved();
    this.lookThrough();
  }

  // What lies over the picture has its camera.
  private lookThrough(): void {
    const { clientWidth, clientHeight } = this.element;
    for (const layer of [this.watchers, this.handles]) layer.setView(this.rig.view(), clientWidth || 1, clientHeight || 1);
  }

  // Of the picture that is asked for: the element's shape, not more pixels than frames can keep up with.
  private pixels(): { width: number; height: number } {
    const width = Math.max(16, this.element.clientWidth);
    const height = Math.max(16, this.element.clientHeight);
    const smaller = Math.min(1, Math.sqrt(MOST_PIXELS / (width * height)));
    return { width: Math.max(16, Math.round(width * smaller)), height: Math.max(16, Math.round(height * smaller)) };
  }

  // How far from there, backwards, the first surface is; nothing where there is none.
  private async behind({ x, y, z }: Placement["translation"]): Promise<number | undefined> {
    try {
      const hit = await unary(this.connection, ResultService.method.pick, {
        session: this.session, camera: { eye: { x, y, z }, target: { x, y, z: z + 1 }, fovDegrees: FIRST_FOV }, width: 16, height: 16, x: 8, y: 8,
      });
      return hit.hit && hit.position ? hit.position.z - z : undefined;
    } catch {
      return undefined; // the view from the front will do
    }
  }

  private async pick(x: number, y: number, more: boolean): Promise<void> {
    const { width, height } = this.pixels();
    try {
      const hit = await unary(this.connection, ResultService.method.pick, {
        session: this.session, camera: this.rig.view(), width, height,
        x: (x / this.element.clientWidth) * width, y: (y / this.element.clientHeight) * height,
      });
      this.reports.picked(hit.hit ? hit.object : "", more);
    } catch (error) {
      this.reports.refused(error);
    }
  }
}
