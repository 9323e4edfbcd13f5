import { create, fromBinary, toBinary } from "@bufbuild/protobuf";
import { StatusSchema } from "../../gen/lpv/v1/status_pb.ts";
import { ToClientSchema, ToServerSchema, type ToServer, type Welcome } from "../../gen/lpv/web/v1/socket_pb.ts";
import { CallError, Code, errorOf } from "./errors.ts";
import { Queue } from "./queue.ts";

// Messages of one call that may be under way before the server has said `taken`.
export const MOST_UNTAKEN = 8;

// One call on a socket: messages out under the server's credit, messages in until its end.
export class Call {
  readonly answers: Queue<Uint8Array>;
  private untaken = 0;
  private over: CallError | undefined;
  private done = false;
  private readonly waiting: (() => void)[] = [];

  constructor(private readonly say: (step: ToServer["step"]) => void, private readonly forget: () => void) {
    this.answers = new Queue(() => this.cancel());
  }

  // Resolves when the message is on its way, which waits for credit.
  async send(message: Uint8Array): Promise<void> {
    while (!this.done && this.untaken >= MOST_UNTAKEN) await new Promise<void>((resolve) => this.waiting.push(resolve));
    if (this.done) throw this.over ?? new CallError(Code.cancelled, "The call has ended.");
    this.untaken += 1;
    this.say({ case: "message", value: message });
  }

  end(): void {
    if (!this.done) this.say({ case: "end", value: true });
  }

  cancel(): void {
    if (this.done) return;
    this.say({ case: "cancel", value: true });
    this.finish(new CallError(Code.cancelled, "The call was given up."));
  }

  took(count: number): void {
    this.untaken = Math.max(0, this.untaken - count);
    for (const resolve of this.waiting.splice(0)) resolve();
  }

  finish(error?: CallError): void {
    if (this.done) return;
    this.done = true;
    this.over = error;
    this.forget();
    this.answers.finish(error);
    for (const resolve of this.waiting.splice(0)) resolve();
  }
}

export interface BeginOptions {
  timeoutMs?: number;
}

// Calls over one WebSocket. Knows the wire only: `send` puts bytes on it, `receive` is given what comes.
export class Socket {
  private lastCall = 0;
  private readonly calls = new Map<number, Call>();
  private over: CallError | undefined;

  constructor(private readonly send: (bytes: Uint8Array) => void, private readonly welcomed: (welcome: Welcome) => void) {}

  hello(token: string): void {
    this.write(0, { case: "hello", value: { $typeName: "lpv.web.v1.Hello", token } });
  }

  begin(method: string, options: BeginOptions = {}): Call {
    if (this.over) throw this.over;
    const id = ++this.lastCall;
    const call = new Call((step) => this.write(id, step), () => this.calls.delete(id));
    this.calls.set(id, call);
    this.write(id, {
      case: "begin",
      value: { $typeName: "lpv.web.v1.Begin", method, timeoutMs: options.timeoutMs ?? 0, traceparent: "" },
    });
    return call;
  }

  receive(bytes: Uint8Array): void {
    const { call: id, step } = fromBinary(ToClientSchema, bytes);
    if (step.case === "welcome") return this.welcomed(step.value);
    const call = this.calls.get(id);
    if (!call) return; // given up meanwhile
    if (step.case === "message") call.answers.push(step.value);
    else if (step.case === "taken") call.took(step.value);
    else if (step.case === "end") call.finish(step.value.code === Code.ok ? undefined : errorOf(step.value));
  }

  // Ends every call with UNAVAILABLE: the connection is gone.
  lose(message: string): void {
    this.over = errorOf(create(StatusSchema, { code: Code.unavailable, message }));
    for (const call of [...this.calls.values()]) call.finish(this.over);
  }

  get openCalls(): number {
    return this.calls.size;
  }

  private write(call: number, step: ToServer["step"]): void {
    if (!this.over) this.send(toBinary(ToServerSchema, create(ToServerSchema, { call, step })));
  }
}
