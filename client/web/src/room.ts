import type { Light } from "../gen/lpv/v1/scene_pb.ts";
import { SessionService } from "../gen/lpv/v1/session_pb.ts";
import { download, el } from "./dom.ts";
import { Drawings } from "./drawings.ts";
import { serverStream } from "./net/calls.ts";
import type { Connection, ConnectionState } from "./net/connection.ts";
import { helpDialog, keyOf, takesText, type Action } from "./panels/keys.ts";
import { Properties } from "./panels/properties.ts";
import { SceneList } from "./panels/scene_list.ts";
import { SettingsDialog } from "./panels/settings.ts";
import { ShareDialog } from "./panels/share.ts";
import { Strip } from "./panels/strip.ts";
import { Words } from "./panels/words.ts";
import { duplicate, place, remove, rename, update, type Fields } from "./scene/actions.ts";
import { LightAreas } from "./scene/areas.ts";
import { Editor } from "./scene/editor.ts";
import type { Added } from "./scene/files/add.ts";
import { boxOf, SceneModel, type SceneObject } from "./scene/model.ts";
import { carried, placementOf, type Placement } from "./scene/placement.ts";
import { accessOf, type Access } from "./scene/role.ts";
import { Selection } from "./scene/selection.ts";
import { Solo } from "./scene/solo.ts";
import { watchScene } from "./scene/watch.ts";
import type { LocalView } from "./local/view.ts";
import type { View } from "./view/camera_rig.ts";
import { Stage } from "./view/stage.ts";

const PRESENCE_MS = 250;
const LOCK_SECONDS = 5;

// One session in the page: the scene on the left, the picture, the selected object on the right.
export class Room {
  readonly model = new SceneModel();
  private readonly editor: Editor;
  private readonly drawings = new Drawings();
  private readonly stage: Stage;
  private readonly words = new Words();
  private readonly strip = new Strip();
  private readonly list: SceneList;
  private readonly properties: Properties;
  private readonly share: ShareDialog;
  private readonly settings: SettingsDialog;
  private readonly chooser = el("input", { type: "file", multiple: true, hidden: true, id: "files", accept: ".glb,.gltf,.bin,.obj,.mtl,.ply,.hdr,.exr,image/*", "aria-label": "Files of lights and scenes" });
  private readonly areas: LightAreas;
  private displayName = "";
  private readonly state = el("span", { class: "state", id: "state", role: "status" });
  private readonly title = el("h1");
  private readonly stop = new AbortController();
  private access: Access = { mayEdit: false, mayShare: false };
  private readonly selection = new Selection();
  private readonly solo = new Solo();
  private followed = ""; // the member whose camera this page's follows
  private drag = ""; // undo group of the drag under way
  private dragged: [SceneObject, Placement][] = []; // what goes along with it, and where each was when it began
  private drags = 0;
  private started = false;
  private homeAt: bigint | undefined; // the revision from which on the first view is another
  private presenceDue: ReturnType<typeof setTimeout> | undefined;
  private readonly actions: Action[];
  private readonly help: HTMLDialogElement;
  private readonly buttons = new Map<string, HTMLButtonElement>();
  readonly element: HTMLElement;

  constructor(private readonly connection: Connection, private readonly session: string, private readonly leave: () => void) {
    this.editor = new Editor(connection, session);
    this.list = new SceneList(this.model, this.selection, (name, more) => this.select(name, more), () => this.followed, (member) => this.follow(member));
    this.properties = new Properties({
      change: (object, fields, paths) => this.change(object, fields, paths),
      place: (object, to) => void this.placeAll(this.places(), placementOf(object.value.transform), to, ""),
      rename: (object, name) => void this.rename(object, name),
      duplicate: () => this.duplicate(),
      remove: () => this.remove(),
    });
    this.areas = new LightAreas(connection, session, () => this.changed());
    this.share = new ShareDialog(connection, session);
    this.settings = new SettingsDialog(connection, session);
    this.stage = new Stage(connection, session, this.editor, this.model, (light) => this.areas.of(light), this.drawings, {
      shown: (frame) => this.strip.frame(frame),
      volume: (field, bytes) => this.strip.volume(field.header.result?.revision ?? 0n, bytes),
      drew: () => this.strip.drew(),
      looking: (local) => this.buttons.get("m")?.setAttribute("aria-pressed", String(local)),
      picked: (name, more) => this.select(name, more),
      cameraMoved: (steered) => {
        if (steered && this.followed) this.follow("");
        this.presenceChanged();
      },
      dragging: (on) => this.dragging(on),
      moved: (to) => this.moved(to),
      refused: this.words.refuse,
      said: (message) => this.words.say(message),
    });
    this.actions = this.allActions();
    this.help = helpDialog(this.actions);
    this.element = this.layout();
    this.takeFiles();
    document.addEventListener("keydown", this.pressed);
    connection.onState((state) => this.showState(state));
    this.model.onChange(() => this.changed());
    setInterval(() => {
      if (!this.stop.signal.aborted) this.strip.draw(this.model.revision, this.model.people.size, this.stage.isLocal);
    }, 500);
    void this.enter();
  }

  // Local shading, where it is on; its camera.
  get shading(): { local: LocalView | undefined; view: View } {
    return { local: this.stage.shading, view: this.stage.rig.view() };
  }

  close(): void {
    this.stop.abort();
    this.stage.close();
    document.removeEventListener("keydown", this.pressed);
    this.editor.leave().catch(() => {}); // a server that is gone forgets the member by itself
  }

  private async enter(): Promise<void> {
    try {
      await this.join();
      this.access = await accessOf(this.connection, this.session);
    } catch (error) {
      this.words.refuse(error);
    }
    for (const action of this.actions) {
      const button = this.buttons.get(action.keys);
      if (button && action.edits) button.disabled = !this.access.mayEdit;
    }
    const share = this.buttons.get("l");
    if (share) share.hidden = !this.access.mayShare;
    await watchScene(this.connection, this.session, () => this.editor.identity, this.model, {
      notice: (message) => this.stage.say(message),
      unknownClient: () => this.join(),
      ended: (error) => this.words.say(`The session is not shown any more. ${error.message}`),
    }, this.stop.signal);
  }

  private async join(): Promise<void> {
    const hue = Math.random() * 2 * Math.PI;
    const part = (shift: number): number => 0.35 + 0.3 * Math.cos(hue + shift);
    this.displayName = await this.editor.join(`Browser ${Math.floor(100 + 900 * Math.random())}`, { x: part(0), y: part(2.1), z: part(4.2) });
  }

  private changed(): void {
    if (!this.started && this.model.grid) {
      this.started = true;
      void this.stage.start(this.access.mayEdit).then(() => this.changed());
    }
    if (this.homeAt !== undefined && this.model.revision >= this.homeAt) {
      this.homeAt = undefined;
      void this.stage.home();
    }
    this.selection.keep((name) => this.model.find(name) !== undefined);
    const followed = this.model.people.get(this.followed);
    if (!followed) this.followed = "";
    else if (followed.camera) this.stage.follow(followed.camera);
    this.drawings.ask(this.drawPanels);
    const object = this.model.find(this.selection.last);
    this.stage.watchers.show(this.model.people.values());
    const distant = object?.kind === "light" && object.value.distant; // nowhere that handles could be
    this.stage.handles.hold(object && !distant ? placementOf(object.value.transform) : undefined, this.selection.last);
  }

  private readonly drawPanels = (): void => {
    const object = this.model.find(this.selection.last);
    this.title.textContent = this.displayName || this.session.replace("sessions/", "");
    this.list.draw();
    this.properties.draw(object, this.selection.names.length - 1, this.access.mayEdit, object?.kind === "light" ? this.areas.of(object.value) : undefined);
  };

  private follow(member: string): void {
    this.followed = member;
    this.changed();
  }

  // `more`: beside what is selected already, or no longer.
  private select(name: string, more = false): void {
    if (more && name) this.selection.flip(name);
    else if (!more) this.selection.take(...(name ? [name] : []));
    this.selectionChanged();
  }

  private selectionChanged(): void {
    this.changed();
    this.drawings.now();
    this.presenceChanged();
  }

  // The one whose handles and numbers are shown is the last.
  private objects(): SceneObject[] {
    return this.selection.names.map((name) => this.model.find(name)).filter((object) => object !== undefined);
  }

  private places(): [SceneObject, Placement][] {
    return this.objects().map((object) => [object, placementOf(object.value.transform)]);
  }

  private dragging(on: boolean): void {
    this.drag = on ? `drag ${++this.drags}` : "";
    this.dragged = on ? this.places() : [];
    this.editor.lock(on ? [...this.selection.names] : [], on ? LOCK_SECONDS : 0).catch(this.words.refuse);
  }

  private async moved(to: Placement): Promise<void> {
    const from = this.dragged.at(-1)?.[1];
    if (!from) return;
    this.stage.moving();
    await this.placeAll(this.dragged, from, to, this.drag);
  }

  // The last goes from one place to another, the others along with it.
  private async placeAll(places: [SceneObject, Placement][], from: Placement, to: Placement, drag: string): Promise<void> {
    const last = places.length - 1;
    const all = places.map(([object, at], i): [SceneObject, Placement] => [object, i === last ? to : carried(at, from, to)]);
    if (all.length > 0) await this.edit(() => place(this.editor, all, drag));
  }

  // Of all selected objects of its kind.
  private change(object: SceneObject, fields: Fields, paths: string[]): void {
    const alike = this.objects().filter(({ kind }) => kind === object.kind);
    void this.edit(() => this.editor.apply(alike.map((one) => update(one, fields, paths))));
  }

  private async edit(apply: () => ReturnType<Editor["apply"]>): Promise<string[]> {
    const began = performance.now();
    try {
      const ack = await apply();
      this.words.clear();
      if (ack) this.strip.edited(ack.revision, began);
      if (ack && ack.skippedFields.length > 0) this.words.say(`Left as they are, since somebody else has changed them: ${ack.skippedFields.join(", ")}.`);
      return ack?.names ?? [];
    } catch (error) {
      this.words.refuse(error);
      return [];
    }
  }

  // Files that are dropped on the page, or chosen.
  private takeFiles(): void {
    this.chooser.addEventListener("change", () => {
      this.add([...(this.chooser.files ?? [])]);
      this.chooser.value = "";
    });
    this.element.addEventListener("dragover", (event) => event.preventDefault());
    this.element.addEventListener("drop", (event) => {
      event.preventDefault();
      this.add([...(event.dataTransfer?.files ?? [])]);
    });
  }

  private add(files: File[]): void {
    if (files.length === 0) return;
    if (!this.access.mayEdit) return this.words.say("This link is for viewing only: nothing can be added.");
    const { grid, surfaces } = this.model;
    const nothingLit = surfaces.size === 0;
    void this.adding(async () => {
      const { FileAdder } = await import("./scene/files/add.ts");
      const adder = new FileAdder(this.connection, this.session, this.editor, (message) => this.words.say(message));
      return adder.add(files, grid && boxOf(grid));
    }, nothingLit);
  }

  // `first`: the camera goes to what is added where that has surfaces.
  private async adding(run: () => Promise<Added>, first: boolean): Promise<void> {
    const stay = (event: BeforeUnloadEvent): void => event.preventDefault();
    window.addEventListener("beforeunload", stay);
    try {
      const added = await run();
      if (first && added.hasSurfaces) this.homeAt = added.acks.at(-1)?.revision;
      this.added(added, first);
    } catch (error) {
      this.words.refuse(error);
    } finally {
      window.removeEventListener("beforeunload", stay);
    }
  }

  private added({ acks, began, warnings, dark }: Added, wasFirst: boolean): void {
    for (const ack of acks) this.strip.edited(ack.revision, began);
    const first = acks[0]?.names[0];
    if (first) this.select(first);
    else this.changed();
    if (!dark) return this.words.sayFew(warnings);
    const { files, asSurfaces } = dark;
    this.words.sayFew([`What is in ${files.join(", ")} was added as lights, since nothing in it emits.`, ...warnings],
      { label: "Add as surfaces instead", run: () => void this.adding(asSurfaces, wasFirst) });
  }

  private async rename(object: SceneObject, name: string): Promise<void> {
    if (!name || name === object.value.name) return;
    const [made] = await this.edit(() => rename(this.editor, object, name));
    if (made) this.select(made);
  }

  private duplicate(): void {
    const objects = this.objects();
    if (objects.length === 0) return;
    void this.edit(() => duplicate(this.editor, objects)).then((made) => {
      if (made.length === 0) return;
      this.selection.take(...made);
      this.selectionChanged();
    });
  }

  private remove(): void {
    const objects = this.objects();
    if (objects.length > 0) void this.edit(() => this.editor.apply(objects.map(remove)));
  }

  // As the last of them is not.
  private toggle(): void {
    const lights = this.objects().filter((object) => object.kind === "light");
    const enabled = lights.at(-1)?.value.enabled === false;
    if (lights.length > 0) void this.edit(() => this.editor.apply(lights.map((light) => update(light, { enabled }, ["enabled"]))));
  }

  private selectLights(): void {
    this.selection.take(...this.model.lights.keys());
    this.selectionChanged();
  }

  private flipSolo(): void {
    const alone = this.objects().filter((object) => object.kind === "light").map(({ value }) => value as Light);
    const operations = this.solo.flip(alone, this.model.lights.values());
    if (operations.length > 0) void this.edit(() => this.editor.apply(operations));
  }

  private frameSelected(): void {
    const object = this.model.find(this.selection.last);
    if (!object) return;
    const { translation, scale } = placementOf(object.value.transform);
    this.stage.frameObject(translation, Math.max(Math.abs(scale.x), Math.abs(scale.y), Math.abs(scale.z)));
  }

  private async saveLinear(): Promise<void> {
    try {
      await this.stage.saveLinear();
    } catch (error) {
      this.words.refuse(error);
    }
  }

  private async saveSession(): Promise<void> {
    const parts: Uint8Array<ArrayBuffer>[] = [];
    try {
      for await (const part of serverStream(this.connection, SessionService.method.exportSession, { name: this.session })) {
        parts.push(part.data as Uint8Array<ArrayBuffer>);
      }
      download(new Blob(parts), `${this.session.replace("sessions/", "")}.lpv`);
    } catch (error) {
      this.words.refuse(error);
    }
  }

  // The newest camera and selection, a few times a second at most.
  private presenceChanged(): void {
    this.presenceDue ??= setTimeout(() => {
      this.presenceDue = undefined;
      const presence = { camera: this.stage.rig.view(), selection: [...this.selection.names] };
      this.editor.tell(presence).catch(() => {}); // transient: the next one says it all again
    }, PRESENCE_MS);
  }

  private showState(state: ConnectionState): void {
    this.state.dataset["kind"] = state.kind;
    const words = {
      connecting: "Connecting", open: "Connected", closed: "Closed",
      lost: "Connection lost, trying again", refused: "Refused: the access token is not good here",
    };
    this.state.textContent = words[state.kind];
    this.state.title = state.kind === "lost" ? `What is shown is the last that was received: ${state.why}` : "";
  }

  private allActions(): Action[] {
    const help = (): void => this.help.showModal();
    const step = (which: "undo" | "redo") => () => void this.edit(() => this.editor[which]());
    return [
      { keys: "g", does: "move what is selected", run: () => this.stage.handles.take("translate"), edits: true },
      { keys: "r", does: "turn it", run: () => this.stage.handles.take("rotate"), edits: true },
      { keys: "y", does: "scale it", run: () => this.stage.handles.take("scale"), edits: true },
      { keys: "x", does: "snap on or off", run: () => this.flip("x", (on) => this.stage.handles.setSnap(on)), edits: true },
      { keys: "b", does: "handles along the object's own axes, or the world's", run: () => this.flip("b", (on) => this.stage.handles.setSpace(on ? "local" : "world")), edits: true },
      { keys: "i", does: "add lights or a scene from files (or drop them): GLB, glTF, OBJ with its MTL, PLY, pictures; HDR and EXR light as the sky", run: () => this.chooser.click(), edits: true },
      { keys: "Ctrl+D", does: "duplicate", run: () => this.duplicate(), edits: true },
      { keys: "Delete", does: "delete", run: () => this.remove(), edits: true },
      { keys: "t", does: "light on or off", run: () => this.toggle(), edits: true },
      { keys: "k", does: "the light alone, or those again that were on beside it", run: () => this.flipSolo(), edits: true },
      { keys: "Ctrl+Z", does: "undo", run: step("undo"), edits: true },
      { keys: "Ctrl+Y", does: "redo", run: step("redo"), edits: true },
      { keys: "f", does: "look at the selected object", run: () => this.frameSelected() },
      { keys: "h", does: "back to the first view", run: () => void this.stage.home() },
      { keys: "/", does: "search the scene", run: () => this.list.focus() },
      { keys: "n", does: "name of the selected object", run: () => document.getElementById("object-name")?.focus() },
      { keys: "v", does: "focus the picture", run: () => this.stage.element.focus() },
      { keys: "Escape", does: "select nothing", run: () => this.select("") },
      { keys: "Ctrl+A", does: "select all lights; a click with Ctrl or Shift, or Shift+Enter in the list, selects one more, or one less", run: () => this.selectLights() },
      { keys: "m", does: "this browser's own shading of the light, or the server's pictures", run: () => void this.stage.flipLook() },
      { keys: "j", does: "a slice of the volume's cells", run: () => void this.stage.flipSlice() },
      { keys: "p", does: "save the picture", run: () => this.stage.savePicture() },
      { keys: "u", does: "save the picture's linear radiance, as EXR", run: () => void this.saveLinear() },
      { keys: "o", does: "save the session as a file", run: () => void this.saveSession() },
      { keys: "c", does: "settings of the session, and what the server chose", run: () => this.settings.open(this.access.mayEdit) },
      { keys: "l", does: "share: links by role", run: () => this.access.mayShare && this.share.open() },
      { keys: "?", does: "this list", run: help },
    ];
  }

  private flip(keys: string, set: (on: boolean) => void): void {
    const button = this.buttons.get(keys);
    const on = button?.getAttribute("aria-pressed") !== "true";
    button?.setAttribute("aria-pressed", String(on));
    set(on);
  }

  private readonly pressed = (event: KeyboardEvent): void => {
    if (document.querySelector("dialog[open]")) return;
    if (event.key === "Escape" && event.target instanceof HTMLElement) event.target.blur();
    else if (takesText(event.target)) return;
    const action = this.actions.find((one) => one.keys === keyOf(event));
    if (!action || (action.edits && !this.access.mayEdit)) return;
    event.preventDefault();
    action.run();
  };

  private layout(): HTMLElement {
    const shown: [string, string][] = [["g", "Move"], ["r", "Turn"], ["y", "Scale"], ["x", "Snap"], ["i", "Add"], ["b", "Axes"],
      ["Ctrl+Z", "Undo"], ["Ctrl+Y", "Redo"], ["h", "Home"], ["m", "Local"], ["p", "Picture"], ["o", "Save"], ["c", "Settings"], ["l", "Share"], ["?", "Keys"]];
    for (const [keys, label] of shown) {
      const action = this.actions.find((one) => one.keys === keys);
      if (!action) continue;
      const button = el("button", { title: `${action.does} (${keys})`, "data-keys": keys, onclick: action.run }, label);
      if (action.edits) button.disabled = true;
      if (keys === "x" || keys === "b" || keys === "m") button.setAttribute("aria-pressed", "false");
      this.buttons.set(keys, button);
    }
    return el("div", { class: "room" },
      el("header", { class: "bar" }, this.title, ...this.buttons.values(), this.exposure(), el("span", { class: "space" }), this.state,
        el("button", { onclick: this.leave }, "Leave")),
      this.list.element, this.stage.element,
      el("aside", { class: "side right", "aria-label": "Selected object" }, this.properties.element),
      this.strip.element, this.words.element, this.chooser, this.help, this.share.element, this.settings.element);
  }

  private exposure(): HTMLElement {
    const input = el("input", { type: "number", step: "0.5", min: -40, max: 40, placeholder: "auto", "aria-label": "Exposure, stops; empty: automatic", id: "exposure" });
    input.addEventListener("change", () => this.stage.setExposure(input.value === "" ? undefined : input.valueAsNumber));
    return el("label", { class: "quiet" }, "Exposure ", input);
  }
}
