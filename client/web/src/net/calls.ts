import {
  create, fromBinary, toBinary,
  type DescMessage, type DescMethod, type DescMethodBiDiStreaming, type DescMethodClientStreaming,
  type DescMethodServerStreaming, type DescMethodUnary, type MessageInitShape, type MessageShape,
} from "@bufbuild/protobuf";
import type { Connection } from "./connection.ts";
import { CallError, Code } from "./errors.ts";
import type { Call } from "./socket.ts";

export interface CallOptions {
  timeoutMs?: number;
  signal?: AbortSignal;
}

const UNARY_MS = 30_000;

async function begin(connection: Connection, method: DescMethod, options: CallOptions): Promise<Call> {
  const socket = await connection.ready(options.signal);
  const name = `${method.parent.typeName}/${method.name}`;
  const call = socket.begin(name, options.timeoutMs === undefined ? {} : { timeoutMs: options.timeoutMs });
  options.signal?.addEventListener("abort", () => call.cancel(), { once: true });
  return call;
}

function bytesOf<I extends DescMessage>(schema: I, request: MessageInitShape<I>): Uint8Array {
  return toBinary(schema, create(schema, request));
}

async function* read<O extends DescMessage>(schema: O, call: Call): AsyncGenerator<MessageShape<O>> {
  for await (const bytes of call.answers) yield fromBinary(schema, bytes);
}

async function only<O extends DescMessage>(schema: O, call: Call): Promise<MessageShape<O>> {
  let answer: MessageShape<O> | undefined;
  for await (const bytes of call.answers) answer = fromBinary(schema, bytes);
  if (answer === undefined) throw new CallError(Code.unknown, "The server ended the call without an answer.");
  return answer;
}

export async function unary<I extends DescMessage, O extends DescMessage>(
  connection: Connection, method: DescMethodUnary<I, O>, request: MessageInitShape<I>, options: CallOptions = {},
): Promise<MessageShape<O>> {
  const call = await begin(connection, method, { timeoutMs: UNARY_MS, ...options });
  await call.send(bytesOf(method.input, request));
  return only(method.output, call);
}

export async function* serverStream<I extends DescMessage, O extends DescMessage>(
  connection: Connection, method: DescMethodServerStreaming<I, O>, request: MessageInitShape<I>, options: CallOptions = {},
): AsyncGenerator<MessageShape<O>> {
  const call = await begin(connection, method, options);
  await call.send(bytesOf(method.input, request));
  call.end();
  yield* read(method.output, call);
}

export async function clientStream<I extends DescMessage, O extends DescMessage>(
  connection: Connection, method: DescMethodClientStreaming<I, O>, requests: Iterable<MessageInitShape<I>>,
  options: CallOptions = {},
): Promise<MessageShape<O>> {
  const call = await begin(connection, method, options);
  for (const request of requests) await call.send(bytesOf(method.input, request));
  call.end();
  return only(method.output, call);
}

export interface Conversation<I extends DescMessage, O extends DescMessage> {
  send(request: MessageInitShape<I>): Promise<void>;
  end(): void;
  answers: AsyncIterable<MessageShape<O>>;
}

export async function converse<I extends DescMessage, O extends DescMessage>(
  connection: Connection, method: DescMethodBiDiStreaming<I, O>, options: CallOptions = {},
): Promise<Conversation<I, O>> {
  const call = await begin(connection, method, options);
  return {
    send: (request) => call.send(bytesOf(method.input, request)),
    end: () => call.end(),
    answers: read(method.output, call),
  };
}
