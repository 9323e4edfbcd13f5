import { Object3D, PerspectiveCamera, Quaternion, Scene, Vector2, Vector3, WebGLRenderer } from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import type { Drawings } from "../drawings.ts";
import { STEP, type Mode, type Space } from "../scene/nudge.ts";
import type { Placement } from "../scene/placement.ts";
import { isSoftware } from "../webgl.ts";
import type { View } from "./camera_rig.ts";

// Handles over the server's picture, seen through the same camera.
export class Gizmo {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(50, 16 / 9, 0.01, 1e4);
  private readonly held = new Object3D();
  private readonly controls: TransformControls;

  constructor(private readonly canvas: HTMLCanvasElement, pointer: HTMLElement, private readonly drawings: Drawings, moved: (to: Placement) => void, dragging: (on: boolean) => void) {
    this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: true });
    this.renderer.setClearColor(0, 0);
    drawings.withPictures = isSoftware(this.renderer.getContext());
    canvas.addEventListener("webglcontextrestored", () => this.draw());
    this.controls = new TransformControls(this.camera, pointer);
    this.controls.setSize(0.8);
    this.scene.add(this.held, this.controls.getHelper());
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("objectChange", () => moved(this.placement()));
    this.controls.addEventListener("dragging-changed", (event) => dragging(event.value === true));
  }

  // Whether the pointer is over a handle or drags one.
  get busy(): boolean {
    return this.controls.object !== undefined && this.controls.axis !== null;
  }

  get dragged(): boolean {
    return this.controls.dragging;
  }

  attach(placement: Placement | undefined): void {
    if (this.dragged) return;
    if (!placement) {
      if (this.controls.object) this.controls.detach();
    } else {
      const { translation: t, rotation: r, scale: s } = placement;
      this.held.position.set(t.x, t.y, t.z);
      this.held.quaternion.set(r.x, r.y, r.z, r.w);
      this.held.scale.set(s.x, s.y, s.z);
      if (this.controls.object !== this.held) this.controls.attach(this.held);
    }
    this.draw();
  }

  setMode(mode: Mode): void {
    this.controls.setMode(mode);
    this.draw();
  }

  setSpace(space: Space): void {
    this.controls.setSpace(space);
    this.draw();
  }

  setSnap(on: boolean): void {
    this.controls.setTranslationSnap(on ? STEP.translate : null);
    this.controls.setRotationSnap(on ? (STEP.rotate * Math.PI) / 180 : null);
    this.controls.setScaleSnap(on ? STEP.scale : null);
  }

  setView(view: View, width: number, height: number): void {
    this.camera.fov = view.fovDegrees;
    this.camera.aspect = width / height;
    this.camera.position.copy(new Vector3(view.eye.x, view.eye.y, view.eye.z));
    this.camera.up.set(0, 1, 0);
    this.camera.lookAt(view.target.x, view.target.y, view.target.z);
    this.camera.updateProjectionMatrix();
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    const now = this.renderer.getSize(new Vector2());
    if (now.x !== width || now.y !== height) this.renderer.setSize(width, height, false);
    this.draw();
  }

  private placement(): Placement {
    const { position: p, scale: s } = this.held;
    const q = new Quaternion().copy(this.held.quaternion).normalize();
    return {
      translation: { x: p.x, y: p.y, z: p.z }, rotation: { x: q.x, y: q.y, z: q.z, w: q.w },
      scale: { x: s.x, y: s.y, z: s.z },
    };
  }

  private draw(): void {
    this.drawings.ask(this.drawNow);
  }

  // An empty layer over the picture would be composed with every frame for nothing.
  private readonly drawNow = (): void => {
    this.canvas.hidden = this.controls.object === undefined;
    if (this.canvas.hidden) return;
    this.camera.updateMatrixWorld();
    this.renderer.render(this.scene, this.camera);
  };
}
