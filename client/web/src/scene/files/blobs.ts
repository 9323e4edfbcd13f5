import { create, toBinary } from "@bufbuild/protobuf";
import { BlobKind, BlobService, MeshSchema, TextureSchema } from "../../../gen/lpv/v1/blob_pb.ts";
import { clientStream, unary } from "../../net/calls.ts";
import type { Connection } from "../../net/connection.ts";
import type { Picture, Triangles } from "./parts.ts";

const PART = 256 * 1024;
const MOST_ASKED = 1000;

interface Blob {
  kind: BlobKind;
  bytes: Uint8Array<ArrayBuffer>;
  hash: string; // empty until it is known
}

// Meshes and textures on their way to the session, each once.
export class Blobs {
  private readonly blobs = new Map<Triangles | Picture, Blob>();

  constructor(private readonly connection: Connection, private readonly session: string) {}

  add(content: Triangles | Picture | undefined): void {
    if (!content || this.blobs.has(content)) return;
    const picture = "texels" in content;
    const bytes = picture ? toBinary(TextureSchema, create(TextureSchema, content)) : meshBytes(content);
    this.blobs.set(content, { kind: picture ? BlobKind.TEXTURE : BlobKind.MESH, bytes: bytes as Uint8Array<ArrayBuffer>, hash: "" });
  }

  // Of what has been uploaded.
  hashOf(content: Triangles | Picture): string {
    return this.blobs.get(content)?.hash ?? "";
  }

  // Sends what the session does not have. `progress` is told the share that is done.
  async upload(progress: (share: number) => void): Promise<void> {
    const there = await this.there();
    const missing = [...this.blobs.values()].filter(({ hash }) => !hash || !there.has(hash));
    const all = missing.reduce((sum, { bytes }) => sum + bytes.length, 0);
    const sent = new Map<string, string>(); // by the hash that the page has made
    let done = 0;
    for (const blob of missing) {
      const { kind, bytes, hash } = blob;
      if (hash && sent.has(hash)) continue;
      const { session } = this;
      function* parts() {
        for (let from = 0; from < bytes.length; from += PART) {
          const data = bytes.subarray(from, from + PART);
          yield from === 0 ? { header: { session, kind, size: BigInt(bytes.length) }, data } : { data };
          done += data.length;
          progress(done / all);
        }
      }
      blob.hash = (await clientStream(this.connection, BlobService.method.uploadBlob, parts())).hash;
      sent.set(blob.hash, blob.hash);
    }
  }

  // Hashes that the session has already. A page that came without TLS from another machine has no means to make any: it sends all.
  private async there(): Promise<Set<string>> {
    const found = new Set<string>();
    if (!globalThis.crypto?.subtle) return found;
    for (const blob of this.blobs.values()) blob.hash = hex(await crypto.subtle.digest("SHA-256", blob.bytes));
    const hashes = [...new Set([...this.blobs.values()].map(({ hash }) => hash))];
    for (let from = 0; from < hashes.length; from += MOST_ASKED) {
      const answer = await unary(this.connection, BlobService.method.findBlobs, { session: this.session, hashes: hashes.slice(from, from + MOST_ASKED) });
      for (const hash of answer.found) found.add(hash);
    }
    return found;
  }
}

const hex = (bytes: ArrayBuffer): string => [...new Uint8Array(bytes)].map((byte) => byte.toString(16).padStart(2, "0")).join("");

const bytesOf = (values: Float32Array | Uint32Array): Uint8Array => new Uint8Array(values.buffer, values.byteOffset, values.byteLength);

function meshBytes({ positions, indices, normals, uvs }: Triangles): Uint8Array {
  return toBinary(MeshSchema, create(MeshSchema, {
    positions: bytesOf(positions), indices: bytesOf(indices),
    ...(normals ? { normals: bytesOf(normals) } : {}), ...(uvs ? { uvs: bytesOf(uvs) } : {}),
  }));
}
