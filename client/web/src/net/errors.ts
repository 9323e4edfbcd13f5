import { fromBinary } from "@bufbuild/protobuf";
import { ErrorInfoSchema, FieldViolationSchema, RetryInfoSchema, type Status } from "../../gen/lpv/v1/status_pb.ts";

// Codes of google.rpc.Code that the page tells apart.
export const Code = {
  ok: 0, cancelled: 1, unknown: 2, invalidArgument: 3, deadlineExceeded: 4, notFound: 5, alreadyExists: 6,
  permissionDenied: 7, resourceExhausted: 8, failedPrecondition: 9, aborted: 10, unimplemented: 12, unavailable: 14,
  unauthenticated: 16,
} as const;

export interface ErrorDetails {
  field?: string; // path from the request
  reason?: string; // name of an ErrorReason
  limit?: string; // name of the limit that was reached
  retryMs?: number; // least pause before the call is repeated
}

// Why a call was refused, in the server's words.
export class CallError extends Error {
  constructor(readonly code: number, message: string, readonly details: ErrorDetails = {}) {
    super(message);
    this.name = "CallError";
  }

  // Whether the same call may succeed a little later.
  get mayRepeat(): boolean {
    return this.code === Code.unavailable || this.details.retryMs !== undefined;
  }
}

export function errorOf(status: Status): CallError {
  const details: ErrorDetails = {};
  for (const any of status.details) {
    const type = any.typeUrl.slice(any.typeUrl.lastIndexOf("/") + 1);
    if (type.endsWith(".FieldViolation")) {
      details.field = fromBinary(FieldViolationSchema, any.value).field;
    } else if (type.endsWith(".ErrorInfo")) {
      const info = fromBinary(ErrorInfoSchema, any.value);
      details.reason = info.reason;
      const limit = info.metadata["limit"];
      if (limit !== undefined) details.limit = limit;
    } else if (type.endsWith(".RetryInfo")) {
      const delay = fromBinary(RetryInfoSchema, any.value).retryDelay;
      if (delay) details.retryMs = Number(delay.seconds) * 1000 + delay.nanos / 1e6;
    }
  }
  return new CallError(status.code, status.message, details);
}

// What people are shown of anything that was thrown.
export function wordsOf(error: unknown): string {
  if (error instanceof CallError && error.message === "") return `The server refused (code ${error.code}).`;
  return error instanceof Error ? error.message : String(error);
}
