import type { Presence } from "../../gen/lpv/v1/session_pb.ts";
import { el } from "../dom.ts";
import { plainHex } from "../scene/emission.ts";
import type { SceneModel } from "../scene/model.ts";
import type { Selection } from "../scene/selection.ts";

// Lights by group, surfaces, and who is here; the search narrows all by name.
export class SceneList {
  private readonly search = el("input", {
    type: "search", placeholder: "Search", "aria-label": "Search the scene", id: "search", oninput: () => this.draw(),
  });
  private readonly list = el("ul", { class: "list" });
  private readonly people = el("ul", { class: "list", "aria-label": "Others here" });
  private shown = "";
  readonly element = el("nav", { class: "side", "aria-label": "Scene" }, this.search, this.list, this.people);

  constructor(
    private readonly model: SceneModel, private readonly selection: Selection, private readonly select: (name: string, more: boolean) => void,
    private readonly followed: () => string, private readonly follow: (member: string) => void,
  ) {}

  focus(): void {
    this.search.focus();
    this.search.select(); // what is typed now is another search
  }

  // Redrawn when something that it shows has changed: not for every step of what is dragged.
  draw(): void {
    const state = this.state();
    if (state === this.shown) return;
    this.shown = state;
    const wanted = this.search.value.toLowerCase();
    const has = (name: string): boolean => name.toLowerCase().includes(wanted);
    const rows: HTMLElement[] = [];
    const groups = new Map<string, string[]>();
    for (const light of this.model.lights.values()) {
      if (has(light.name)) groups.set(light.group, [...(groups.get(light.group) ?? []), light.name]);
    }
    for (const [group, names] of [...groups].sort(([a], [b]) => a.localeCompare(b))) {
      rows.push(heading(group ? `Lights: ${group}` : "Lights"), ...names.sort().map((name) => this.row(name)));
    }
    const surfaces = [...this.model.surfaces.keys()].filter(has).sort();
    if (surfaces.length > 0) rows.push(heading("Surfaces"), ...surfaces.map((name) => this.row(name)));
    if (rows.length === 0) rows.push(el("li", { class: "quiet" }, wanted ? "Nothing of that name." : "The scene is empty."));
    keepFocus(this.list, rows);
    this.drawPeople();
  }

  private state(): string {
    const { lights, surfaces, people } = this.model;
    return JSON.stringify([this.search.value, this.selection.names, this.followed(), [...surfaces.keys()],
      [...lights.values()].map(({ name, group, enabled }) => [name, group, enabled]),
      [...people.values()].map(({ clientId, displayName, colour, selection, locked, camera }) =>
        [clientId, displayName, colour && plainHex(colour), selection, locked, camera !== undefined])]);
  }

  private row(name: string): HTMLElement {
    const light = this.model.lights.get(name);
    const holder = this.model.lockHolder(name);
    const viewers = [...this.model.people.values()].filter((person) => person.selection.includes(name));
    const button = el("button", { "data-name": name, onclick: (event) => this.select(name, adds(event)) },
      el("span", light && light.enabled === false ? { class: "off" } : {}, name),
      ...viewers.map((person) => swatch(person.colour, `selected by ${person.displayName}`)),
      holder ? el("span", { class: "quiet" }, `locked by ${holder.displayName || "another member"}`) : undefined);
    button.setAttribute("aria-current", String(this.selection.has(name)));
    return el("li", {}, button);
  }

  private drawPeople(): void {
    const rows = [...this.model.people.values()].map((person) =>
      el("li", { class: "row" }, swatch(person.colour, ""), person.displayName || "a member",
        el("span", { class: "quiet" }, person.selection.join(", ")), this.followButton(person)));
    keepFocus(this.people, rows.length > 0 ? [heading("Also here"), ...rows] : []);
  }

  // Looks from where they look, until this page's own camera is moved.
  private followButton(person: Presence): HTMLElement | undefined {
    if (!person.camera) return undefined;
    const on = this.followed() === person.clientId;
    const button = el("button", { "data-name": person.clientId, onclick: () => this.follow(on ? "" : person.clientId) }, "Follow");
    button.setAttribute("aria-pressed", String(on));
    button.setAttribute("aria-label", `Follow the camera of ${person.displayName || "a member"}`);
    return button;
  }
}

// With Ctrl or Shift a click, or Shift+Enter, is about one more object, or one less.
function adds(event: Event): boolean {
  return event instanceof MouseEvent && (event.ctrlKey || event.metaKey || event.shiftKey);
}

function heading(text: string): HTMLElement {
  return el("li", {}, el("h2", {}, text));
}

function swatch(colour: { x: number; y: number; z: number } | undefined, title: string): SVGElement {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("class", "swatch");
  svg.setAttribute("viewBox", "0 0 10 10");
  if (title) svg.setAttribute("aria-label", title);
  const dot = document.createElementNS("http://www.w3.org/2000/svg", "circle");
  dot.setAttribute("cx", "5");
  dot.setAttribute("cy", "5");
  dot.setAttribute("r", "5");
  dot.setAttribute("fill", plainHex(colour ?? { x: 0.3, y: 0.3, z: 0.3 }));
  svg.append(dot);
  return svg;
}

// Replaces the rows; the object whose button had the focus has it again.
function keepFocus(list: HTMLElement, rows: HTMLElement[]): void {
  const focused = list.contains(document.activeElement) ? document.activeElement?.getAttribute("data-name") : undefined;
  list.replaceChildren(...rows);
  if (!focused) return;
  for (const button of list.querySelectorAll("button")) if (button.dataset["name"] === focused) button.focus();
}
