import { create, type MessageInitShape } from "@bufbuild/protobuf";
import {
  EditSchema, OperationSchema, SceneService, type EditAck, type LightSchema, type SurfaceSchema,
} from "../../gen/lpv/v1/scene_pb.ts";
import { SessionService, type ClientIdentity, type PresenceSchema } from "../../gen/lpv/v1/session_pb.ts";
import { unary } from "../net/calls.ts";
import type { Connection } from "../net/connection.ts";
import { CallError, Code } from "../net/errors.ts";

export type OperationInit = MessageInitShape<typeof OperationSchema>;
export type LightInit = MessageInitShape<typeof LightSchema>;
export type SurfaceInit = MessageInitShape<typeof SurfaceSchema>;

interface Waiting {
  key: string; // of a drag: a later edit with the same key replaces this one; empty: never replaced
  operations: OperationInit[];
  undoGroup: string;
  settle: ((ack: EditAck | undefined, error?: unknown) => void)[];
}

const MOST_REPEATS = 20;

// This page as a member of the session: its identity, and its edits one after another. An edit whose outcome is not
// known is repeated with the same sequence, so that it happens once.
export class Editor {
  identity: ClientIdentity | undefined;
  private sequence = 0n;
  private readonly waiting: Waiting[] = [];
  private sending = false;
  private sent: Promise<void> = Promise.resolve(); // all edits that were asked for

  constructor(private readonly connection: Connection, private readonly session: string) {}

  // Answers the session's name for people.
  async join(displayName: string, colour: { x: number; y: number; z: number }): Promise<string> {
    const answer = await unary(this.connection, SessionService.method.joinSession, { session: this.session, displayName, colour });
    this.identity = answer.client;
    this.sequence = 0n;
    return answer.session?.settings?.displayName ?? "";
  }

  async leave(): Promise<void> {
    if (this.identity) await unary(this.connection, SessionService.method.leaveSession, { session: this.session, client: this.identity });
  }

  // Applies the operations as one edit. With a key, newer values take the place of those that still wait.
  apply(operations: OperationInit[], options: { key?: string; undoGroup?: string } = {}): Promise<EditAck | undefined> {
    const key = options.key ?? "";
    return new Promise((resolve, reject) => {
      const settle = (ack: EditAck | undefined, error?: unknown): void => (error ? reject(error) : resolve(ack));
      const same = key ? this.waiting.find((edit) => edit.key === key) : undefined;
      if (same) {
        same.operations = operations;
        same.settle.push(settle);
      } else {
        this.waiting.push({ key, operations, undoGroup: options.undoGroup ?? "", settle: [settle] });
      }
      if (!this.sending) this.sent = this.drain();
    });
  }

  undo(): Promise<EditAck | undefined> {
    return this.step("undo");
  }

  redo(): Promise<EditAck | undefined> {
    return this.step("redo");
  }

  async tell(presence: MessageInitShape<typeof PresenceSchema>): Promise<void> {
    if (!this.identity) return;
    await unary(this.connection, SessionService.method.updatePresence, { session: this.session, client: this.identity, presence });
  }

  async lock(objects: string[], seconds: number): Promise<void> {
    if (!this.identity) return;
    const ttl = { seconds: BigInt(seconds), nanos: 0 };
    await unary(this.connection, SceneService.method.lockObjects, { session: this.session, client: this.identity, objects, ttl });
  }

  // After the edits that were asked for before it.
  private async step(which: "undo" | "redo"): Promise<EditAck | undefined> {
    await this.sent;
    const sequence = ++this.sequence;
    const request = { session: this.session, sequence, ...this.client() };
    const answer = await this.repeated<{ ack?: EditAck }>(() =>
      which === "undo"
        ? unary(this.connection, SceneService.method.undo, request)
        : unary(this.connection, SceneService.method.redo, request));
    return answer.ack;
  }

  private async drain(): Promise<void> {
    this.sending = true;
    for (let edit = this.waiting.shift(); edit; edit = this.waiting.shift()) {
      const { settle } = edit;
      try {
        const ack = await this.send(edit);
        for (const done of settle) done(ack);
      } catch (error) {
        for (const done of settle) done(undefined, error);
      }
    }
    this.sending = false;
  }

  private async send(waiting: Waiting): Promise<EditAck | undefined> {
    const sequence = this.identity ? ++this.sequence : 0n;
    const edit = create(EditSchema, { sequence, operations: waiting.operations, undoGroup: waiting.undoGroup });
    const answer = await this.repeated(() =>
      unary(this.connection, SceneService.method.applyEdit, { session: this.session, edit, ...this.client() }));
    return answer.ack;
  }

  private client(): { client?: ClientIdentity } {
    return this.identity ? { client: this.identity } : {};
  }

  // Repeats what may succeed later, where a repetition cannot happen twice.
  private async repeated<T>(call: () => Promise<T>): Promise<T> {
    for (let attempt = 1; ; ++attempt) {
      try {
        return await call();
      } catch (error) {
        const again = error instanceof CallError && error.mayRepeat && error.code !== Code.cancelled && this.identity;
        if (!again || attempt >= MOST_REPEATS) throw error;
        await new Promise((resolve) => setTimeout(resolve, error.details.retryMs ?? 200));
      }
    }
  }
}
