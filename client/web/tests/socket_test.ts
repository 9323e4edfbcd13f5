import assert from "node:assert/strict";
import { test } from "node:test";
import { create, fromBinary, toBinary } from "@bufbuild/protobuf";
import { anyPack } from "@bufbuild/protobuf/wkt";
import { ErrorInfoSchema, FieldViolationSchema, RetryInfoSchema, StatusSchema } from "../gen/lpv/v1/status_pb.ts";
import { ToClientSchema, ToServerSchema, type ToClient, type ToServer } from "../gen/lpv/web/v1/socket_pb.ts";
import { Backoff } from "../src/net/backoff.ts";
import { CallError, Code } from "../src/net/errors.ts";
import { MOST_UNTAKEN, Socket } from "../src/net/socket.ts";

function opened() {
  const sent: ToServer[] = [];
  const socket = new Socket((bytes) => sent.push(fromBinary(ToServerSchema, bytes)), () => {});
  const give = (call: number, step: ToClient["step"]): void =>
    socket.receive(toBinary(ToClientSchema, create(ToClientSchema, { call, step })));
  return { socket, sent, give };
}

const settled = () => new Promise((resolve) => setImmediate(resolve));

test("calls count up from 1 and answers reach the call that they are of", async () => {
  const { socket, sent, give } = opened();
  const first = socket.begin("a/B");
  const second = socket.begin("a/C", { timeoutMs: 7 });
  assert.deepEqual(sent.map((message) => message.call), [1, 2]);
  give(2, { case: "message", value: new Uint8Array([2]) });
  give(1, { case: "message", value: new Uint8Array([1]) });
  assert.deepEqual((await second.answers.next()).value, new Uint8Array([2]));
  assert.deepEqual((await first.answers.next()).value, new Uint8Array([1]));
  give(1, { case: "end", value: create(StatusSchema) });
  assert.equal((await first.answers.next()).done, true);
  assert.equal(socket.openCalls, 1);
});

test("no more than eight messages are under way that the server has not taken", async () => {
  const { socket, sent, give } = opened();
  const call = socket.begin("a/B");
  const sending = Array.from({ length: MOST_UNTAKEN + 2 }, () => call.send(new Uint8Array()));
  const messages = () => sent.filter((message) => message.step.case === "message").length;
  await settled();
  assert.equal(messages(), 8);
  give(1, { case: "taken", value: 1 });
  await settled();
  assert.equal(messages(), 9);
  give(1, { case: "taken", value: 8 });
  await Promise.all(sending);
  assert.equal(messages(), 10);
});

test("a refusal carries field, reason, limit and pause", async () => {
  const { socket, give } = opened();
  const call = socket.begin("a/B");
  const info = anyPack(ErrorInfoSchema, create(ErrorInfoSchema, { reason: "MAX_LIGHTS", metadata: { limit: "max_lights" } }));
  info.typeUrl = "type.googleapis.com/google.rpc.ErrorInfo";
  const retry = anyPack(RetryInfoSchema, create(RetryInfoSchema, { retryDelay: { seconds: 1n, nanos: 500_000_000 } }));
  const field = anyPack(FieldViolationSchema, create(FieldViolationSchema, { field: "edit.operations[0]" }));
  give(1, { case: "end", value: create(StatusSchema, { code: 8, message: "max_lights", details: [info, retry, field] }) });
  await assert.rejects(call.answers.next(), (error: unknown) => {
    assert.ok(error instanceof CallError);
    assert.equal(error.code, Code.resourceExhausted);
    assert.deepEqual(error.details, { reason: "MAX_LIGHTS", limit: "max_lights", retryMs: 1500, field: "edit.operations[0]" });
    return error.mayRepeat;
  });
});

test("a lost socket ends every call, and those that wait for credit", async () => {
  const { socket } = opened();
  const call = socket.begin("a/B");
  for (let i = 0; i < MOST_UNTAKEN; ++i) await call.send(new Uint8Array());
  const waiting = call.send(new Uint8Array());
  const reading = call.answers.next();
  socket.lose("gone");
  await assert.rejects(waiting, { message: "gone" });
  await assert.rejects(reading, { code: Code.unavailable });
  assert.throws(() => socket.begin("a/B"), { message: "gone" });
});

test("a reader that leaves its loop cancels the call", async () => {
  const { socket, sent, give } = opened();
  const call = socket.begin("a/B");
  give(1, { case: "message", value: new Uint8Array([1]) });
  for await (const _ of call.answers) break;
  assert.equal(sent.at(-1)?.step.case, "cancel");
  assert.equal(socket.openCalls, 0);
});

test("pauses double up to their bound and start again after a success", () => {
  const backoff = new Backoff(100, 500, () => 0);
  assert.deepEqual([1, 2, 3, 4, 5].map(() => backoff.next()), [100, 200, 400, 500, 500]);
  backoff.reset();
  assert.equal(backoff.next(), 100);
});
