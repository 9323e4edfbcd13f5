import type { Box, Camera, Grid } from "../../gen/lpv/v1/geometry_pb.ts";
import type { Light, SceneChange, SceneSnapshot, Surface } from "../../gen/lpv/v1/scene_pb.ts";
import type { Presence, SessionSettings } from "../../gen/lpv/v1/session_pb.ts";

export type SceneObject = { kind: "light"; value: Light } | { kind: "surface"; value: Surface };

// The scene as the server last told it, and who else is here. Changes come in parts; readers see whole ones only.
export class SceneModel {
  readonly lights = new Map<string, Light>();
  readonly surfaces = new Map<string, Surface>();
  readonly cameras = new Map<string, Camera>();
  readonly people = new Map<string, Presence>();
  settings: SessionSettings | undefined;
  grid: Grid | undefined;
  revision = 0n;
  epoch = 0n;
  private inSnapshot = false;
  private readonly listeners = new Set<() => void>();

  onChange(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  find(name: string): SceneObject | undefined {
    const light = this.lights.get(name);
    if (light) return { kind: "light", value: light };
    const surface = this.surfaces.get(name);
    return surface && { kind: "surface", value: surface };
  }

  // The member, other than this page, that has locked the object.
  lockHolder(name: string): Presence | undefined {
    return [...this.people.values()].find((person) => person.locked.includes(name));
  }

  takeSnapshot(part: SceneSnapshot): void {
    if (!this.inSnapshot) this.clear();
    this.inSnapshot = part.more;
    this.put(part);
    if (part.more) return;
    this.epoch = part.epoch;
    this.revision = part.revision;
    this.tell();
  }

  takeChange(part: SceneChange): void {
    for (const name of part.deletedLights) this.lights.delete(name);
    for (const name of part.deletedSurfaces) this.surfaces.delete(name);
    for (const name of part.deletedCameras) this.cameras.delete(name);
    this.put(part);
    if (part.more) return;
    this.epoch = part.epoch;
    this.revision = part.lastRevision;
    this.tell();
  }

  takePresence(person: Presence): void {
    if (person.gone) this.people.delete(person.clientId);
    else this.people.set(person.clientId, person);
    this.tell();
  }

  // A stream begins: whoever is present will be told again, and so will a snapshot that broke off.
  beginWatch(): void {
    this.people.clear();
    this.inSnapshot = false;
    this.tell();
  }

  private clear(): void {
    this.lights.clear();
    this.surfaces.clear();
    this.cameras.clear();
    this.revision = 0n; // until the snapshot is whole
  }

  private put(part: SceneSnapshot | SceneChange): void {
    for (const light of part.lights) this.lights.set(light.name, light);
    for (const surface of part.surfaces) this.surfaces.set(surface.name, surface);
    for (const camera of part.cameras) this.cameras.set(camera.name, camera);
    if (part.settings) this.settings = part.settings;
    if (part.grid) this.grid = part.grid;
  }

  private tell(): void {
    for (const listener of this.listeners) listener();
  }
}

export function boxOf(grid: Grid): Box | undefined {
  const { origin, dims, cellSize } = grid;
  if (!origin || !dims || cellSize <= 0) return undefined;
  return {
    $typeName: "lpv.v1.Box",
    min: origin,
    max: {
      $typeName: "lpv.v1.Vec3",
      x: origin.x + dims.x * cellSize, y: origin.y + dims.y * cellSize, z: origin.z + dims.z * cellSize,
    },
  };
}
