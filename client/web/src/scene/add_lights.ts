import { create, toBinary } from "@bufbuild/protobuf";
import { BlobKind, BlobService, MeshSchema, TextureFormat, TextureSchema } from "../../gen/lpv/v1/blob_pb.ts";
import type { Box } from "../../gen/lpv/v1/geometry_pb.ts";
import { clientStream } from "../net/calls.ts";
import type { Connection } from "../net/connection.ts";
import type { DroppedLight, DroppedMesh } from "./dropped.ts";
import type { OperationInit } from "./editor.ts";

const PART = 256 * 1024;

// Uploads what lights of files need, and says how they are made, in the middle of `box` where their own place is not in
// it. `progress` is told the share that is uploaded.
export async function addLights(connection: Connection, session: string, lights: readonly DroppedLight[], box: Box | undefined,
  progress: (share: number) => void): Promise<OperationInit[]> {
  const blobs = lights.map((light) => ({ light, mesh: meshOf(light), texture: textureOf(light) }));
  const all = blobs.reduce((sum, { mesh, texture }) => sum + (mesh?.length ?? 0) + (texture?.length ?? 0), 0);
  let sent = 0;
  const upload = async (kind: BlobKind, bytes: Uint8Array): Promise<string> => {
    function* parts() {
      for (let from = 0; from < bytes.length; from += PART) {
        const data = bytes.subarray(from, from + PART);
        yield from === 0 ? { header: { session, kind, size: BigInt(bytes.length) }, data } : { data };
        sent += data.length;
        progress(sent / all);
      }
    }
    return (await clientStream(connection, BlobService.method.uploadBlob, parts())).hash;
  };
  const made: OperationInit[] = [];
  for (const { light, mesh, texture } of blobs) {
    made.push({
      operation: {
        case: "createLight",
        value: {
          name: light.name,
          ...(mesh ? { mesh: await upload(BlobKind.MESH, mesh) } : {}),
          ...("sky" in light
            ? { distant: true }
            : { transform: { translation: placeOf(light, box) }, emission: { case: "radiance", value: light.radiance }, twoSided: light.twoSided }),
          ...(texture ? { texture: await upload(BlobKind.TEXTURE, texture) } : {}),
        },
      },
    });
  }
  return made;
}

// The server has the sky's.
function meshOf(light: DroppedLight): Uint8Array | undefined {
  if ("sky" in light) return undefined;
  const { positions, indices, uvs } = light;
  return toBinary(MeshSchema, create(MeshSchema, { positions, indices, ...(uvs ? { uvs } : {}) }));
}

function textureOf(light: DroppedLight): Uint8Array | undefined {
  if ("sky" in light) return toBinary(TextureSchema, create(TextureSchema, { ...light.sky, format: TextureFormat.RGB16F }));
  return light.texture && toBinary(TextureSchema, create(TextureSchema, { ...light.texture, format: TextureFormat.RGB8_SRGB }));
}

function placeOf({ min, max }: DroppedMesh, box: Box | undefined): { x: number; y: number; z: number } {
  const low = box?.min;
  const high = box?.max;
  if (!low || !high) return { x: 0, y: 0, z: 0 };
  const inside = (axis: "x" | "y" | "z"): boolean => min[axis] >= low[axis] && max[axis] <= high[axis];
  const moved = (axis: "x" | "y" | "z"): number => (low[axis] + high[axis] - min[axis] - max[axis]) / 2;
  return inside("x") && inside("y") && inside("z") ? { x: 0, y: 0, z: 0 } : { x: moved("x"), y: moved("y"), z: moved("z") };
}
