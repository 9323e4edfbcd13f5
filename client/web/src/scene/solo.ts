import type { Light } from "../../gen/lpv/v1/scene_pb.ts";
import { update } from "./actions.ts";
import type { OperationInit } from "./editor.ts";

const switched = (lights: Light[], enabled: boolean): OperationInit[] => lights.map((value) => update({ kind: "light", value }, { enabled }, ["enabled"]));
const isOn = (light: Light): boolean => light.enabled !== false;

// Lights alone: the others go off in one edit, for everybody, and all that went off come on again in another. Whoever
// goes from one light to the next has the next alone.
export class Solo {
  private silenced = new Set<string>(); // lights that this page has turned off for another's sake

  flip(alone: Light[], all: Iterable<Light>): OperationInit[] {
    if (alone.length === 0) return [];
    const others = [...all].filter((light) => !alone.some(({ name }) => name === light.name));
    const on = others.filter(isOn);
    const operations = on.length > 0
      ? [...switched(on, false), ...switched(alone.filter((light) => !isOn(light)), true)]
      : switched(others.filter((light) => this.silenced.has(light.name)), true);
    this.silenced = on.length > 0 ? new Set([...this.silenced, ...on.map((light) => light.name)]) : new Set();
    return operations;
  }
}
