import { fromBinary } from "@bufbuild/protobuf";
import { BlobService, MeshSchema } from "../../gen/lpv/v1/blob_pb.ts";
import { serverStream } from "../net/calls.ts";
import type { Connection } from "../net/connection.ts";

export interface MeshData {
  positions: Float32Array;
  normals: Float32Array | undefined; // else the triangles'
  indices: Uint32Array;
}

// Meshes of a session by hash, each read once.
export class Meshes {
  private readonly known = new Map<string, MeshData | "asked">();

  constructor(private readonly connection: Connection, private readonly session: string, private readonly learned: () => void) {}

  get(hash: string): MeshData | undefined {
    const known = this.known.get(hash);
    if (known === undefined) void this.read(hash);
    return known === "asked" ? undefined : known;
  }

  // Only these are kept.
  keep(hashes: ReadonlySet<string>): void {
    for (const hash of this.known.keys()) if (!hashes.has(hash)) this.known.delete(hash);
  }

  private async read(hash: string): Promise<void> {
    this.known.set(hash, "asked");
    try {
      const parts: Uint8Array[] = [];
      for await (const part of serverStream(this.connection, BlobService.method.readBlob, { session: this.session, hash })) parts.push(part.data);
      const bytes = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
      let at = 0;
      for (const part of parts) {
        bytes.set(part, at);
        at += part.length;
      }
      const mesh = fromBinary(MeshSchema, bytes);
      this.known.set(hash, {
        positions: new Float32Array(mesh.positions.slice().buffer),
        normals: mesh.normals.length > 0 ? new Float32Array(mesh.normals.slice().buffer) : undefined,
        indices: new Uint32Array(mesh.indices.slice().buffer),
      });
      this.learned();
    } catch {
      this.known.delete(hash); // asked for again when the scene is drawn the next time
    }
  }
}
