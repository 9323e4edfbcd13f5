import { Notice_Kind, SceneService } from "../../gen/lpv/v1/scene_pb.ts";
import type { ClientIdentity } from "../../gen/lpv/v1/session_pb.ts";
import { serverStream } from "../net/calls.ts";
import type { Connection } from "../net/connection.ts";
import { Backoff } from "../net/backoff.ts";
import { CallError } from "../net/errors.ts";
import { FINAL } from "../net/stay_open.ts";
import type { SceneModel } from "./model.ts";

export interface WatchReports {
  notice(message: string): void;
  unknownClient(): Promise<void>; // the server does not know this member any more
  ended(error: CallError): void; // the scene will not be told any more
}

// Follows the scene until `signal`: a lost stream is opened again where it was left.
export async function watchScene(
  connection: Connection, session: string, identity: () => ClientIdentity | undefined, model: SceneModel,
  reports: WatchReports, signal: AbortSignal,
): Promise<void> {
  const backoff = new Backoff();
  while (!signal.aborted) {
    try {
      await connection.ready(signal);
      const client = identity();
      model.beginWatch();
      const request = {
        session, sinceRevision: model.revision, sinceEpoch: model.epoch, ...(client ? { client } : {}),
      };
      for await (const { event } of serverStream(connection, SceneService.method.watchScene, request, { signal })) {
        backoff.reset();
        if (event.case === "snapshot") model.takeSnapshot(event.value);
        else if (event.case === "change") model.takeChange(event.value);
        else if (event.case === "presence") model.takePresence(event.value);
        else if (event.case === "notice") reports.notice(event.value.message || `Notice: ${Notice_Kind[event.value.kind]}`);
      }
    } catch (error) {
      if (signal.aborted) return;
      if (error instanceof CallError && error.details.reason === "UNKNOWN_CLIENT") await reports.unknownClient();
      else if (error instanceof CallError && FINAL.includes(error.code)) return reports.ended(error);
    }
    await new Promise((resolve) => setTimeout(resolve, backoff.next()));
  }
}
