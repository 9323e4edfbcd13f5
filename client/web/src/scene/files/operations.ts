import { create, toBinary } from "@bufbuild/protobuf";
import { AlphaMode, OperationSchema } from "../../../gen/lpv/v1/scene_pb.ts";
import type { OperationInit, SurfaceInit } from "../editor.ts";
import type { FileCamera, Part, Picture, Triangles } from "./parts.ts";
import type { Sky } from "./read.ts";

const MOST_OPERATIONS = 1000;
const MOST_BYTES = 900_000; // of an edit: a message may have 1 MiB

export type HashOf = (content: Triangles | Picture) => string;

// The pictures of a part that a session shows: none without texture coordinates.
export function picturesOf({ triangles, material }: Part): Picture[] {
  if (!triangles.uvs) return [];
  return [material.texture, material.normals, material.gloss].filter((one) => one !== undefined);
}

export function lightFrom({ name, triangles, placement, material }: Part, hashOf: HashOf): OperationInit {
  const { texture, radiance, doubleSided } = material;
  return {
    operation: {
      case: "createLight",
      value: {
        name, mesh: hashOf(triangles), transform: placement, emission: { case: "radiance", value: radiance }, twoSided: doubleSided,
        ...(texture && triangles.uvs ? { texture: hashOf(texture) } : {}),
      },
    },
  };
}

export function surfaceFrom({ name, triangles, placement, material }: Part, hashOf: HashOf): OperationInit {
  const { texture, normals, gloss } = triangles.uvs ? material : {};
  const { albedo, roughness, metalness, alphaMode, alphaCutoff, opacity, transmission, normalScale } = material;
  const value: SurfaceInit = {
    name, mesh: hashOf(triangles), transform: placement, albedo, roughness, metalness, twoSided: !material.oneSidedSurface,
    ...(texture ? { albedoTexture: hashOf(texture) } : {}),
    ...(normals ? { normalTexture: hashOf(normals), normalScale } : {}),
    ...(gloss ? { glossTexture: hashOf(gloss) } : {}),
    ...(alphaMode === AlphaMode.OPAQUE ? {} : { alphaMode, alphaCutoff, opacity, transmission }),
  };
  return { operation: { case: "createSurface", value } };
}

// All of the sky: the server has its mesh.
export function skyFrom({ name, picture }: Sky, hashOf: HashOf): OperationInit {
  return { operation: { case: "createLight", value: { name, distant: true, texture: hashOf(picture) } } };
}

export const cameraFrom = (value: FileCamera): OperationInit => ({ operation: { case: "putCamera", value } });
export const fitGrid = (): OperationInit => ({ operation: { case: "fitGrid", value: {} } });

// As few edits as the server takes them in.
export function inEdits(operations: readonly OperationInit[]): OperationInit[][] {
  const edits: OperationInit[][] = [[]];
  let bytes = 0;
  for (const operation of operations) {
    const size = toBinary(OperationSchema, create(OperationSchema, operation)).length + 8;
    if ((edits.at(-1)?.length ?? 0) === MOST_OPERATIONS || bytes + size > MOST_BYTES) {
      edits.push([]);
      bytes = 0;
    }
    bytes += size;
    edits.at(-1)?.push(operation);
  }
  return edits;
}
