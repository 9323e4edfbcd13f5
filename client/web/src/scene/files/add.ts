import type { Box } from "../../../gen/lpv/v1/geometry_pb.ts";
import type { EditAck } from "../../../gen/lpv/v1/scene_pb.ts";
import { SessionService } from "../../../gen/lpv/v1/session_pb.ts";
import { unary } from "../../net/calls.ts";
import type { Connection } from "../../net/connection.ts";
import type { Editor, OperationInit } from "../editor.ts";
import { Blobs } from "./blobs.ts";
import { cameraFrom, fitGrid, inEdits, lightFrom, picturesOf, skyFrom, surfaceFrom } from "./operations.ts";
import { broughtInto } from "./place.ts";
import { readDropped, type Dropped, type FileScene } from "./read.ts";

export interface Added {
  acks: EditAck[];
  began: number; // when the first edit was sent, as performance.now() has it
  warnings: string[];
}

// Adds what people drop to the session, as one undo step. Lights come into the middle of `box` where their own place is not in it; a
// file with surfaces stays where it is, and the grid is fitted to it unless its bounds are fixed.
export async function addFiles(connection: Connection, session: string, editor: Editor, files: readonly File[], box: Box | undefined,
  say: (message: string) => void): Promise<Added> {
  say(`Reading ${files.map(({ name }) => name).join(", ")}.`);
  const dropped = await readDropped(files);
  const blobs = new Blobs(connection, session);
  addBlobs(dropped, blobs);
  await blobs.upload((share) => say(`Uploading: ${(100 * share).toFixed(0)} %`));
  const operations = operationsFor(dropped, blobs, box);
  if (dropped.scenes.some(hasSurfaces) && !(await boundsAreFixed(connection, session))) operations.push(fitGrid());
  const began = performance.now();
  return { acks: await applyAll(editor, inEdits(operations)), began, warnings: dropped.warnings };
}

const hasSurfaces = ({ surfaces }: FileScene): boolean => surfaces.length > 0;

function addBlobs({ scenes, skies }: Dropped, blobs: Blobs): void {
  for (const part of scenes.flatMap(({ lights, surfaces }) => [...lights, ...surfaces])) {
    blobs.add(part.triangles);
    for (const picture of picturesOf(part)) blobs.add(picture);
  }
  for (const { picture } of skies) blobs.add(picture);
}

function operationsFor({ scenes, skies }: Dropped, blobs: Blobs, box: Box | undefined): OperationInit[] {
  const hashOf = blobs.hashOf.bind(blobs);
  const ofScene = (scene: FileScene): OperationInit[] => [
    ...(hasSurfaces(scene) ? scene.lights : broughtInto(scene.lights, box)).map((part) => lightFrom(part, hashOf)),
    ...scene.surfaces.map((part) => surfaceFrom(part, hashOf)),
    ...scene.cameras.map(cameraFrom),
  ];
  return [...scenes.flatMap(ofScene), ...skies.map((sky) => skyFrom(sky, hashOf))];
}

async function boundsAreFixed(connection: Connection, name: string): Promise<boolean> {
  const { session } = await unary(connection, SessionService.method.getSession, { name });
  return session?.settings?.grid?.bounds !== undefined;
}

let drops = 0;

// Where a later edit is refused, those before it are taken back.
async function applyAll(editor: Editor, edits: OperationInit[][]): Promise<EditAck[]> {
  const undoGroup = `files ${++drops}`;
  const acks: EditAck[] = [];
  try {
    for (const operations of edits) {
      const ack = await editor.apply(operations, { undoGroup });
      if (ack) acks.push(ack);
    }
  } catch (error) {
    if (acks.length > 0) await editor.undo();
    throw error;
  }
  return acks;
}
