import type { Light, Surface } from "../../gen/lpv/v1/scene_pb.ts";
import { el, labelled } from "../dom.ts";
import {
  LUMENS_PER_WATT, emittingArea, fromHex, fromKelvins, lumens, luminance, plainColour, plainHex, radianceOf, scaled, strongest, toHex, toKelvins, watts,
  type Colour,
} from "../scene/emission.ts";
import type { Fields } from "../scene/actions.ts";
import type { SceneObject } from "../scene/model.ts";
import { anglesOf, placementOf, rotationOf, type Placement } from "../scene/placement.ts";

export interface PropertyActions {
  change(object: SceneObject, fields: Fields, paths: string[]): void;
  place(object: SceneObject, to: Placement): void;
  rename(object: SceneObject, name: string): void;
  duplicate(): void;
  remove(): void;
}

// The fields of the selected object as numbers and colours.
export class Properties {
  readonly element = el("section", { class: "side-part", "aria-label": "Properties" });
  private shown = "";

  constructor(private readonly actions: PropertyActions) {}

  // Redrawn when the object is another or has changed; not under somebody's fingers.
  // `area` is that of one side of a light, m^2, where it is known.
  // `others`: so many are selected with it.
  draw(object: SceneObject | undefined, others: number, mayEdit: boolean, area: number | undefined): void {
    const state = object ? `${object.kind} ${object.value.name} ${revisionOf(object)} ${others} ${mayEdit} ${area}` : `none ${mayEdit}`;
    const active = document.activeElement;
    const typing = active instanceof HTMLInputElement && active.type !== "checkbox" && this.element.contains(active);
    if (state === this.shown || (typing && object && this.shown.startsWith(`${object.kind} ${object.value.name} `))) return;
    this.shown = state;
    if (!object) {
      this.element.replaceChildren(el("p", { class: "quiet" }, "Click an object in the picture or in the list to select it."));
      return;
    }
    this.element.replaceChildren(this.common(object, others), this.placement(object),
      object.kind === "light" ? this.light(object, object.value, area) : this.surface(object, object.value), this.buttons());
    for (const control of this.element.querySelectorAll<HTMLInputElement | HTMLButtonElement>("input, button")) control.disabled = !mayEdit;
    if (!mayEdit) this.element.append(el("p", { class: "quiet" }, "Your access is for viewing only."));
  }

  private common(object: SceneObject, others: number): HTMLElement {
    const kind = object.kind === "light" ? "Light" : "Surface";
    const name = text(object.value.name, (value) => this.actions.rename(object, value));
    name.id = "object-name";
    return el("div", { class: "group" }, el("h2", {}, others === 0 ? kind : `${kind} and ${others} more`), labelled("Name", name),
      others === 0 ? undefined : el("p", { class: "quiet" }, `The others move along, and what is set here is set for every selected ${kind.toLowerCase()}.`));
  }

  private placement(object: SceneObject): HTMLElement {
    const now = placementOf(object.value.transform);
    const angles = anglesOf(now.rotation);
    const move = (part: Partial<Placement>): void => this.actions.place(object, { ...now, ...part });
    return el("div", { class: "group" },
      triple("Position, m", now.translation, (translation) => move({ translation })),
      triple("Rotation, deg", angles, (value) => move({ rotation: rotationOf(value) })),
      triple("Scale", now.scale, (scale) => move({ scale })));
  }

  private light(object: SceneObject, light: Light, oneSide: number | undefined): HTMLElement {
    const area = emittingArea(light, oneSide ?? 0);
    const radiance = radianceOf(light, area);
    const set = (value: Colour): void =>
      this.actions.change(object, { emission: { case: "radiance", value: { $typeName: "lpv.v1.Vec3", ...value } } }, ["radiance"]);
    const measured = oneSide !== undefined && !light.distant; // the sky has a radiance, and no area
    const strength = strongest(radiance);
    const byFactor = (now: number) => (wanted: number): void => {
      if (now > 0) set(scaled(radiance, wanted / now));
    };
    const warmth = toKelvins(radiance);
    const warmed = (kelvins: number): void => {
      const body = fromKelvins(kelvins);
      set(scaled(body, (luminance(radiance) || 1) / luminance(body)));
    };
    const power = watts(radiance, area);
    const flux = lumens(radiance, area);
    return el("div", { class: "group" },
      labelled("Colour", colour(toHex(radiance), (hex) => set(scaled(fromHex(hex), strength || 1)))),
      labelled("Temperature, K", number(Math.round((warmth ?? 0) / 10) * 10, 0, warmed, warmth !== undefined)),
      labelled("Radiance", number(strength, 0, (value) => set(strength > 0 ? scaled(radiance, value / strength) : { x: value, y: value, z: value }))),
      labelled("Power, W", number(power, 0, byFactor(power), measured)),
      labelled("Light, lm", number(flux, 0, byFactor(flux), measured)),
      el("p", { class: "quiet" }, `Temperature of a black body of this colour, where there is one: another keeps the light in lumens. Radiance in W/(sr m²) of the strongest colour; power of all three together; ${LUMENS_PER_WATT} lm/W times the luminance. ${!measured ? "" : `Emitting area ${area.toFixed(3)} m².`}`),
      labelled("Group", text(light.group, (group) => this.actions.change(object, { group }, ["group"]))),
      this.flag(object, "Enabled", "enabled", light.enabled !== false),
      this.flag(object, "Distant", "distant", light.distant),
      this.flag(object, "Two-sided", "two_sided", light.twoSided),
      this.flag(object, "Casts shadow", "casts_shadow", light.castsShadow !== false));
  }

  private surface(object: SceneObject, surface: Surface): HTMLElement {
    const albedo = surface.albedo ?? { x: 0.8, y: 0.8, z: 0.8 };
    return el("div", { class: "group" },
      labelled("Reflectance", colour(plainHex(albedo), (hex) =>
        this.actions.change(object, { albedo: { $typeName: "lpv.v1.Vec3", ...plainColour(hex) } }, ["albedo"]))),
      labelled("Roughness", number(surface.roughness ?? 1, 0, (roughness) => this.actions.change(object, { roughness }, ["roughness"]))),
      this.flag(object, "Two-sided", "two_sided", surface.twoSided !== false),
      this.flag(object, "Casts shadow", "casts_shadow", surface.castsShadow !== false));
  }

  private flag(object: SceneObject, label: string, path: "enabled" | "two_sided" | "casts_shadow" | "distant", on: boolean): HTMLElement {
    const box = el("input", { type: "checkbox", checked: on });
    box.addEventListener("change", () => {
      const fields = { enabled: { enabled: box.checked }, two_sided: { twoSided: box.checked }, casts_shadow: { castsShadow: box.checked }, distant: { distant: box.checked } };
      this.actions.change(object, fields[path], [path]);
    });
    return labelled(label, box);
  }

  private buttons(): HTMLElement {
    return el("div", { class: "row" },
      el("button", { onclick: () => this.actions.duplicate() }, "Duplicate"),
      el("button", { onclick: () => this.actions.remove() }, "Delete"));
  }
}

function revisionOf(object: SceneObject): bigint {
  return object.kind === "light" ? (object.value.status?.revision ?? 0n) : object.value.revision;
}

function text(value: string, changed: (value: string) => void): HTMLInputElement {
  const input = el("input", { type: "text", value, maxlength: 200 });
  input.addEventListener("change", () => changed(input.value.trim()));
  return input;
}

function number(value: number, least: number | undefined, changed: (value: number) => void, known = true): HTMLInputElement {
  const shown = known ? String(Number(value.toPrecision(5))) : "";
  const input = el("input", { type: "number", value: shown, step: "any", ...(least === undefined ? {} : { min: least }) });
  input.addEventListener("change", () => {
    if (input.value !== "" && Number.isFinite(input.valueAsNumber)) changed(input.valueAsNumber);
  });
  return input;
}

function colour(value: string, changed: (value: string) => void): HTMLInputElement {
  const input = el("input", { type: "color", value });
  input.addEventListener("change", () => changed(input.value));
  return input;
}

function triple(label: string, value: Colour, changed: (value: Colour) => void): HTMLElement {
  const inputs = (["x", "y", "z"] as const).map((axis) => {
    const input = number(value[axis], undefined, (wanted) => changed({ ...value, [axis]: wanted }));
    input.setAttribute("aria-label", `${label} ${axis}`);
    return input;
  });
  return el("div", { class: "field" }, el("span", {}, label), el("div", { class: "three" }, ...inputs));
}
