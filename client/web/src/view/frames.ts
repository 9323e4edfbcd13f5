import { ResultService, type FrameHeader, type FramePart } from "../../gen/lpv/v1/result_pb.ts";
import { FrameFormat } from "../../gen/lpv/v1/result_pb.ts";
import type { ClientIdentity } from "../../gen/lpv/v1/session_pb.ts";
import { converse } from "../net/calls.ts";
import type { Connection } from "../net/connection.ts";
import { stayOpen } from "../net/stay_open.ts";
import type { View } from "./camera_rig.ts";
import { Pace } from "./pace.ts";

const REST_MS = 500;

export interface ShownFrame {
  header: FrameHeader;
  revision: bigint;
  bytes: number;
  cameraMs: number | undefined; // from the camera's change to this picture of it
}

export interface FrameReports {
  shown(frame: ShownFrame): void;
  trouble(message: string): void; // empty: none any more
}

type Talk = Awaited<ReturnType<typeof converse<typeof ResultService.method.streamFrames.input, typeof ResultService.method.streamFrames.output>>>;

// Pictures that the server draws for this page's camera, newest only: each is acknowledged when it is drawn.
export class FrameView {
  private talk: Talk | undefined;
  private cameraSequence = 0n;
  private pendingCamera: View | undefined;
  private sendingCamera = false;
  private readonly cameraSent = new Map<bigint, number>();
  private readonly stop = new AbortController();
  private width = 640;
  private height = 360;
  private readonly pace = new Pace();
  private asked = 1; // share of width and height that the server was last asked for
  private lastShown = -Infinity;
  private lastMoved = -Infinity;
  private rest: ReturnType<typeof setTimeout> | undefined;
  subscriber = "";

  constructor(
    private readonly canvas: HTMLCanvasElement, private readonly connection: Connection, private readonly session: string,
    private readonly identity: () => ClientIdentity | undefined, private readonly view: () => View,
    private readonly reports: FrameReports,
  ) {}

  start(width: number, height: number): void {
    this.width = width;
    this.height = height;
    void this.run();
  }

  close(): void {
    clearTimeout(this.rest);
    this.stop.abort();
  }

  cameraMoved(): void {
    this.moving();
    this.pendingCamera = this.view();
    void this.sendCameras();
  }

  resize(width: number, height: number): void {
    if (width === this.width && height === this.height) return;
    this.width = width;
    this.height = height;
    this.say(this.size());
  }

  // Camera or objects are being moved: pictures that the server cannot make often enough become smaller, and large again
  // when everything rests.
  moving(): void {
    this.lastMoved = performance.now();
    clearTimeout(this.rest);
    this.rest = setTimeout(() => this.ask(1), REST_MS);
  }

  private ask(share: number): void {
    if (share === this.asked) return;
    this.asked = share;
    this.say(this.size());
  }

  private size(): { width: number; height: number } {
    const part = (edge: number): number => Math.max(16, Math.round(edge * this.asked));
    return { width: part(this.width), height: part(this.height) };
  }

  private paced(now: number): void {
    const since = now - this.lastShown;
    this.lastShown = now;
    if (now - this.lastMoved > REST_MS) return;
    this.ask(this.pace.next(this.asked, since));
  }

  setExposure(ev: number | undefined): void {
    this.exposure = ev === undefined ? { case: "automatic", value: true } : { case: "ev", value: ev };
    this.say({ exposure: { exposure: this.exposure } });
  }

  private exposure: { case: "automatic"; value: boolean } | { case: "ev"; value: number } = { case: "automatic", value: true };

  private say(update: { width?: number; height?: number; exposure?: { exposure: FrameView["exposure"] } }): void {
    this.talk?.send({ message: { case: "update", value: update } }).catch(() => {}); // a lost stream says so by its end
  }

  private async run(): Promise<void> {
    const { signal } = this.stop;
    await stayOpen(signal, async (alive) => {
      try {
        await this.follow(signal, alive);
      } finally {
        this.talk = undefined;
        this.subscriber = "";
      }
    }, this.reports.trouble);
  }

  private async follow(signal: AbortSignal, alive: () => void): Promise<void> {
    const talk = await converse(this.connection, ResultService.method.streamFrames, { signal });
    const client = this.identity();
    await talk.send({
      message: {
        case: "subscription",
        value: {
          session: this.session, ...this.size(), format: FrameFormat.JPEG, quality: 85,
          maxRate: 30, adaptRate: 15, sharpen: true, exposure: { exposure: this.exposure }, camera: this.nextCamera(this.view()),
          ...(client ? { client } : {}),
        },
      },
    });
    this.talk = talk;
    let parts: FramePart[] = [];
    for await (const { event } of talk.answers) {
      const said = event?.event;
      if (said?.case === "subscribed") this.subscriber = said.value.subscriber;
      if (said?.case === "notice" && said.value.message) this.reports.trouble(said.value.message);
      if (said?.case !== "part") continue;
      if (said.value.header) parts = [];
      parts.push(said.value);
      const header = parts[0]?.header;
      if (!header || parts.length < header.partCount) continue;
      alive();
      await this.show(header, parts);
      await talk.send({ message: { case: "update", value: { acknowledge: { resultId: said.value.resultId } } } });
    }
  }

  private async show(header: FrameHeader, parts: FramePart[]): Promise<void> {
    const file = new Blob(parts.map((part) => part.payload as Uint8Array<ArrayBuffer>), { type: "image/jpeg" });
    const picture = await createImageBitmap(file);
    if (this.canvas.width !== picture.width) this.canvas.width = picture.width;
    if (this.canvas.height !== picture.height) this.canvas.height = picture.height;
    this.canvas.getContext("2d", { alpha: false })?.drawImage(picture, 0, 0);
    picture.close();
    this.canvas.dataset["sharp"] = String(header.sharp);
    if (!header.sharp) this.paced(performance.now());
    const sent = this.cameraSent.get(header.cameraSequence);
    for (const sequence of this.cameraSent.keys()) if (sequence <= header.cameraSequence) this.cameraSent.delete(sequence);
    this.reports.trouble("");
    this.reports.shown({
      header, revision: header.result?.revision ?? 0n, bytes: file.size,
      cameraMs: sent === undefined ? undefined : performance.now() - sent,
    });
  }

  private nextCamera(view: View) {
    this.cameraSequence += 1n;
    this.cameraSent.set(this.cameraSequence, performance.now());
    return { camera: view, sequence: this.cameraSequence };
  }

  // One camera at a time under way: while it waits for credit, newer ones take the place of those not sent yet.
  private async sendCameras(): Promise<void> {
    if (this.sendingCamera) return;
    this.sendingCamera = true;
    try {
      for (let view = this.pendingCamera; view && this.talk; view = this.pendingCamera) {
        this.pendingCamera = undefined;
        await this.talk.send({ message: { case: "update", value: { camera: this.nextCamera(view) } } });
      }
    } catch {
      // the stream is lost; the next one begins with the camera as it is then
    } finally {
      this.sendingCamera = false;
    }
  }
}
