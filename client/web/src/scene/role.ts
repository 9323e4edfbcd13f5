import { BlobService } from "../../gen/lpv/v1/blob_pb.ts";
import { SessionService } from "../../gen/lpv/v1/session_pb.ts";
import { unary } from "../net/calls.ts";
import type { Connection } from "../net/connection.ts";
import { CallError, Code } from "../net/errors.ts";

export interface Access {
  mayEdit: boolean;
  mayShare: boolean; // may make tokens: an owner's access, on a server that asks for tokens
}

// The protocol does not say which role a token has: two calls that change nothing tell.
export async function accessOf(connection: Connection, session: string): Promise<Access> {
  const denied = async (call: () => Promise<unknown>): Promise<number> => {
    try {
      await call();
      return Code.ok;
    } catch (error) {
      if (error instanceof CallError && error.code !== Code.unavailable) return error.code;
      throw error;
    }
  };
  const edit = await denied(() => unary(connection, BlobService.method.findBlobs, { session, hashes: [] }));
  const share = await denied(() => unary(connection, SessionService.method.listTokens, { session }));
  return { mayEdit: edit !== Code.permissionDenied && edit !== Code.unauthenticated, mayShare: share === Code.ok };
}
