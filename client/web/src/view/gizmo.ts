import {
  BufferGeometry, Color, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Object3D, PerspectiveCamera, Quaternion, Scene,
  Vector2, Vector3, WebGLRenderer,
} from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import type { Drawings } from "../drawings.ts";
import type { Placement } from "../scene/placement.ts";
import { isSoftware } from "../webgl.ts";
import type { Point, View } from "./camera_rig.ts";

export type GizmoMode = "translate" | "rotate" | "scale";

// Somebody else's camera.
export interface Watcher {
  view: View;
  colour: Point; // linear Rec.709
}

const PYRAMID = 0.3; // metres from the eye to the picture's plane
const NEAR = 0.5; // metres: whose eye is nearer than that is not shown

// Handles over the server's picture, and where others look from, seen through the same camera.
export class Gizmo {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(50, 16 / 9, 0.01, 1e4);
  private readonly held = new Object3D();
  private readonly controls: TransformControls;
  private readonly others = new Group();
  private watchers = "";

  constructor(private readonly canvas: HTMLCanvasElement, pointer: HTMLElement, private readonly drawings: Drawings, moved: (to: Placement) => void, dragging: (on: boolean) => void) {
    this.renderer = new WebGLRenderer({ canvas, alpha: true, antialias: true });
    this.renderer.setClearColor(0, 0);
    drawings.withPictures = isSoftware(this.renderer.getContext());
    canvas.addEventListener("webglcontextrestored", () => this.draw());
    this.controls = new TransformControls(this.camera, pointer);
    this.controls.setSize(0.8);
    this.scene.add(this.held, this.controls.getHelper(), this.others);
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

  // A pyramid each, in their colours.
  setWatchers(watchers: Watcher[]): void {
    const said = JSON.stringify(watchers);
    if (said === this.watchers) return;
    this.watchers = said;
    for (const old of this.others.children as LineSegments<BufferGeometry, LineBasicMaterial>[]) {
      old.geometry.dispose();
      old.material.dispose();
    }
    this.others.clear();
    this.others.add(...watchers.map(pyramid));
    this.draw();
  }

  setMode(mode: GizmoMode): void {
    this.controls.setMode(mode);
    this.draw();
  }

  setSpace(space: "world" | "local"): void {
    this.controls.setSpace(space);
    this.draw();
  }

  // Metres, degrees and factors; 0 does not snap.
  setSnap(on: boolean): void {
    this.controls.setTranslationSnap(on ? 0.1 : null);
    this.controls.setRotationSnap(on ? Math.PI / 12 : null);
    this.controls.setScaleSnap(on ? 0.1 : null);
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
    for (const other of this.others.children) other.visible = other.position.distanceTo(this.camera.position) > NEAR;
    this.canvas.hidden = this.controls.object === undefined && !this.others.children.some((other) => other.visible);
    if (this.canvas.hidden) return;
    this.camera.updateMatrixWorld();
    this.renderer.render(this.scene, this.camera);
  };
}

function pyramid({ view, colour }: Watcher): LineSegments {
  const up = PYRAMID * Math.tan((view.fovDegrees * Math.PI) / 360), aside = (16 / 9) * up;
  const corners = [[aside, up], [-aside, up], [-aside, -up], [aside, -up]].map(([x = 0, y = 0]) => [x, y, PYRAMID]);
  const lines = corners.flatMap((corner, i) => [0, 0, 0, ...corner, ...corner, ...(corners[(i + 1) % 4] ?? [])]);
  const geometry = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(lines, 3));
  const shown = new LineSegments(geometry, new LineBasicMaterial({ color: new Color(colour.x, colour.y, colour.z) }));
  shown.position.set(view.eye.x, view.eye.y, view.eye.z);
  shown.lookAt(view.target.x, view.target.y, view.target.z);
  return shown;
}
