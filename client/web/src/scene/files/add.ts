import type { Box } from "../../../gen/lpv/v1/geometry_pb.ts";
import type { EditAck } from "../../../gen/lpv/v1/scene_pb.ts";
import { SessionService } from "../../../gen/lpv/v1/session_pb.ts";
import { unary } from "../../net/calls.ts";
import type { Connection } from "../../net/connection.ts";
import type { Editor, OperationInit } from "../editor.ts";
import { Blobs } from "./blobs.ts";
import { cameraFrom, fitGrid, inEdits, lightFrom, picturesOf, skyFrom, surfaceFrom, type HashOf } from "./operations.ts";
import { broughtInto } from "./place.ts";
import { readDropped, type Dropped, type FileScene } from "./read.ts";

export interface Added {
  acks: EditAck[];
  began: number; // when the first edit was sent, as performance.now() has it
  warnings: string[];
  hasSurfaces: boolean;
  dark?: Dark;
}

// Files in which nothing emits, whose meshes have become lights; they can become surfaces instead.
export interface Dark {
  files: string[];
  asSurfaces(): Promise<Added>;
}

// Adds files to a session. What is added at once is one undo step.
export class FileAdder {
  private steps = 0;

  constructor(private readonly connection: Connection, private readonly session: string, private readonly editor: Editor,
    private readonly say: (message: string) => void) {}

  // Lights come into the middle of `box` where their own place is not in it; a file with surfaces stays where it is, and the grid is
  // fitted to it unless its bounds are fixed.
  async add(files: readonly File[], box: Box | undefined): Promise<Added> {
    this.say(`Reading ${files.map(({ name }) => name).join(", ")}.`);
    const dropped = await readDropped(files);
    const hashOf = await this.upload(dropped);
    const operations = operationsFor(dropped, hashOf, box);
    const lit = dropped.scenes.some(hasSurfaces);
    if (lit) operations.push(...(await this.fit()));
    const added = { ...(await this.apply(operations)), warnings: dropped.warnings, hasSurfaces: lit };
    const dark = dropped.scenes.filter((scene) => scene.dark);
    if (dark.length === 0) return added;
    const names = lightsMade(dropped, added.acks.flatMap((ack) => ack.names));
    return { ...added, dark: { files: dark.map(({ file }) => file), asSurfaces: () => this.instead(dark, names) } };
  }

  // The lights that were made of these files go, and what the files say comes where they say.
  private async instead(dark: readonly FileScene[], names: readonly string[]): Promise<Added> {
    const scenes = dark.map(({ file, dark: { parts, cameras } = { parts: [], cameras: [] } }) => ({ file, lights: [], surfaces: parts, cameras }));
    const dropped: Dropped = { scenes, skies: [], warnings: [] };
    const hashOf = await this.upload(dropped);
    const gone = names.map((value): OperationInit => ({ operation: { case: "deleteLight", value } }));
    const operations = [...gone, ...operationsFor(dropped, hashOf, undefined), ...(await this.fit())]; // names are free before they are given
    return { ...(await this.apply(operations)), warnings: [], hasSurfaces: true };
  }

  private async upload(dropped: Dropped): Promise<HashOf> {
    const blobs = new Blobs(this.connection, this.session);
    addBlobs(dropped, blobs);
    await blobs.upload((share) => this.say(`Uploading: ${(100 * share).toFixed(0)} %`));
    return (content) => blobs.hashOf(content);
  }

  private async fit(): Promise<OperationInit[]> {
    const { session } = await unary(this.connection, SessionService.method.getSession, { name: this.session });
    return session?.settings?.grid?.bounds === undefined ? [fitGrid()] : [];
  }

  // Where a later edit is refused, those before it are taken back.
  private async apply(operations: readonly OperationInit[]): Promise<Pick<Added, "acks" | "began">> {
    const undoGroup = `files ${++this.steps}`;
    const acks: EditAck[] = [];
    const began = performance.now();
    try {
      for (const edit of inEdits(operations)) {
        const ack = await this.editor.apply(edit, { undoGroup });
        if (ack) acks.push(ack);
      }
    } catch (error) {
      if (acks.length > 0) await this.editor.undo();
      throw error;
    }
    return { acks, began };
  }
}

const hasSurfaces = ({ surfaces }: FileScene): boolean => surfaces.length > 0;

function addBlobs({ scenes, skies }: Dropped, blobs: Blobs): void {
  for (const part of scenes.flatMap(({ lights, surfaces }) => [...lights, ...surfaces])) {
    blobs.add(part.triangles);
    for (const picture of picturesOf(part)) blobs.add(picture);
  }
  for (const { picture } of skies) blobs.add(picture);
}

function operationsFor({ scenes, skies }: Dropped, hashOf: HashOf, box: Box | undefined): OperationInit[] {
  const ofScene = (scene: FileScene): OperationInit[] => [
    ...(hasSurfaces(scene) ? scene.lights : broughtInto(scene.lights, box)).map((part) => lightFrom(part, hashOf)),
    ...scene.surfaces.map((part) => surfaceFrom(part, hashOf)),
    ...scene.cameras.map(cameraFrom),
  ];
  return [...scenes.flatMap(ofScene), ...skies.map((sky) => skyFrom(sky, hashOf))];
}

// Of the names that the session gave to what operationsFor makes: those of lights of files in which nothing emits.
function lightsMade({ scenes }: Dropped, names: readonly string[]): string[] {
  let at = 0;
  return scenes.flatMap(({ lights, surfaces, cameras, dark }) => {
    const first = at;
    at += lights.length + surfaces.length + cameras.length;
    return dark ? names.slice(first, first + lights.length) : [];
  });
}
