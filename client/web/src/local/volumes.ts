import { ResultService } from "../../gen/lpv/v1/result_pb.ts";
import type { ClientIdentity } from "../../gen/lpv/v1/session_pb.ts";
import { PayloadCompression, VolumeFormat, VolumeStage, type VolumePart } from "../../gen/lpv/v1/volume_pb.ts";
import { converse } from "../net/calls.ts";
import type { Connection } from "../net/connection.ts";
import { stayOpen } from "../net/stay_open.ts";
import { Field } from "./field.ts";

export interface VolumeReports {
  volume(field: Field, bytes: number): void;
  trouble(message: string): void; // empty: none any more
}

// The session's volume, newest only; each is acknowledged when it is taken. What a delta leaves out stays.
export class VolumeFollower {
  private readonly stop = new AbortController();
  private field: Field | undefined;
  private heldId = 0n;

  constructor(private readonly connection: Connection, private readonly session: string,
    private readonly identity: () => ClientIdentity | undefined, private readonly reports: VolumeReports) {
    const { signal } = this.stop;
    void stayOpen(signal, (alive) => this.follow(signal, alive), reports.trouble);
  }

  close(): void {
    this.stop.abort();
  }

  private async follow(signal: AbortSignal, alive: () => void): Promise<void> {
    const talk = await converse(this.connection, ResultService.method.streamVolume, { signal });
    const client = this.identity();
    await talk.send({
      message: {
        case: "subscription",
        value: {
          session: this.session, stage: VolumeStage.TRANSPORTED, format: VolumeFormat.HALF_FLOAT,
          compression: PayloadCompression.NONE, guardCells: 1, ...(client ? { client } : {}),
        },
      },
    });
    this.heldId = 0n;
    let parts: VolumePart[] = [];
    for await (const { event } of talk.answers) {
      const said = event?.event;
      if (said?.case === "notice" && said.value.message) this.reports.trouble(said.value.message);
      if (said?.case !== "part") continue;
      if (said.value.header) parts = [];
      parts.push(said.value);
      const header = parts[0]?.header;
      if (!header || parts.length < header.partCount) continue;
      alive();
      const taken = this.take(parts);
      await talk.send({
        message: { case: "update", value: taken ? { acknowledge: { resultId: said.value.resultId } } : { requestKeyFrame: true } },
      });
    }
  }

  // False for a delta to what this page does not hold.
  private take(parts: VolumePart[]): boolean {
    const header = parts[0]?.header;
    if (!header) return false;
    if (header.baseResultId === 0n) this.field = new Field(header);
    else if (!this.field || header.baseResultId !== this.heldId) return false;
    const { field } = this;
    if (!field) return false;
    for (const part of parts) field.take(part);
    field.header = header;
    this.heldId = header.result?.resultId ?? 0n;
    this.reports.trouble("");
    this.reports.volume(field, parts.reduce((sum, part) => sum + part.payload.length, 0));
    return true;
  }
}
