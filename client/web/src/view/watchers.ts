import type { Presence } from "../../gen/lpv/v1/session_pb.ts";
import type { Drawings } from "../drawings.ts";
import { plainHex } from "../scene/emission.ts";
import type { Point, View } from "./camera_rig.ts";
import { Projection, worldFromCamera } from "./projection.ts";

const PYRAMID = 0.3; // metres from the eye to the picture's plane
const NEAR = 0.5; // metres: whose eye is nearer than that is not shown
const LONGEST_NAME = 24;
const SVG = "http://www.w3.org/2000/svg";

interface Watcher {
  name: string;
  colour: Point; // linear Rec.709
  view: View;
}

// Where the others look from: a pyramid each with the name, lines over the picture. The list of members says the same in
// words.
export class Watchers {
  readonly element = svg("svg", { class: "watchers", "aria-hidden": "true", hidden: "" });
  private watchers: Watcher[] = [];
  private said = "[]";
  private view: View | undefined;
  private width = 1;
  private height = 1;

  constructor(private readonly drawings: Drawings) {}

  // Those whose cameras are known.
  show(people: Iterable<Presence>): void {
    const watchers: Watcher[] = [];
    for (const { camera, colour, displayName } of people) {
      if (!camera?.eye || !camera.target) continue;
      const { eye, target, fovDegrees } = camera;
      watchers.push({ name: displayName || "a member", colour: colour ?? { x: 0.3, y: 0.3, z: 0.3 }, view: { eye, target, fovDegrees: fovDegrees || 50 } });
    }
    const said = JSON.stringify(watchers);
    if (said === this.said) return;
    this.said = said;
    this.watchers = watchers;
    this.drawings.ask(this.draw);
  }

  setView(view: View, width: number, height: number): void {
    this.view = view;
    this.width = width;
    this.height = height;
    if (this.watchers.length > 0) this.drawings.ask(this.draw);
  }

  // An empty layer over the picture would be composed with every frame for nothing.
  private readonly draw = (): void => {
    const { view } = this;
    const seen = view ? this.watchers.filter(({ view: { eye } }) => apart(eye, view.eye) > NEAR) : [];
    this.element.toggleAttribute("hidden", seen.length === 0);
    if (!view || seen.length === 0) return this.element.replaceChildren();
    const projection = new Projection(view, this.width, this.height);
    this.element.replaceChildren(...seen.flatMap((watcher) => drawn(watcher, projection)));
  };
}

function drawn({ name, colour, view }: Watcher, projection: Projection): SVGElement[] {
  const up = PYRAMID * Math.tan((view.fovDegrees * Math.PI) / 360);
  const aside = (16 / 9) * up;
  const corners = [[aside, up], [-aside, up], [-aside, -up], [aside, -up]].map(([x = 0, y = 0]) => worldFromCamera(view, { x, y, z: PYRAMID }));
  const edges = corners.flatMap((corner, i) => [projection.line(view.eye, corner), projection.line(corner, corners[(i + 1) % 4] ?? corner)]);
  const d = edges.map((edge) => (edge ? `M${pixels(edge[0])}L${pixels(edge[1])}` : "")).join("");
  const label = projection.point(view.eye);
  const shown: SVGElement[] = [svg("path", { class: "under", d }), svg("path", { d, stroke: plainHex(colour) })];
  if (!label) return shown;
  const text = svg("text", { x: String(Math.round(label[0])), y: String(Math.round(label[1]) - 8) });
  text.textContent = name.length > LONGEST_NAME ? `${name.slice(0, LONGEST_NAME - 1)}…` : name;
  return [...shown, text];
}

const pixels = ([x, y]: readonly [number, number]): string => `${x.toFixed(1)} ${y.toFixed(1)}`;
const apart = (a: Point, b: Point): number => Math.hypot(a.x - b.x, a.y - b.y, a.z - b.z);

function svg<K extends keyof SVGElementTagNameMap>(tag: K, attributes: Record<string, string>): SVGElementTagNameMap[K] {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  return element;
}
