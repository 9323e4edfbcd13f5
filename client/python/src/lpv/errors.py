"""Why a call or an edit was refused: code, field and reason, as PROTOCOL.md ("Errors") has them."""

from __future__ import annotations

from typing import Any, Iterable

import grpc

from lpv.v1 import status_pb2

DETAILS = "grpc-status-details-bin"
ERROR_INFO = "type.googleapis.com/google.rpc.ErrorInfo"
# A stream that ends with one of these is opened again, and an edit that was not answered is sent again.
REOPEN = frozenset({grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.UNKNOWN, grpc.StatusCode.INTERNAL, grpc.StatusCode.OK})
_CODES = {code.value[0]: code for code in grpc.StatusCode}


class Error(Exception):
    """A refusal, or a connection that failed. Programs decide by code, reason and field; the text is for people."""

    def __init__(self, code: grpc.StatusCode, message: str, field: str = "", reason: str = "",
                 metadata: dict[str, str] | None = None) -> None:
        super().__init__(message)
        self.code = code
        self.message = message
        #: path from the request, "edit.operations[3].create_light.radiance"; empty where no field is to blame
        self.field = field
        #: name of an ErrorReason, "MAX_LIGHTS"; empty where the code says all
        self.reason = reason
        #: what the reason needs: {"limit": "max_lights"}
        self.metadata = metadata or {}

    def __repr__(self) -> str:
        return f"Error({self.code.name}, {self.message!r}, field={self.field!r}, reason={self.reason!r})"


def from_status(status: status_pb2.Status) -> Error:
    """Of an lpv.v1.Status: EditAck.status, or the details of a call."""
    field, reason, metadata = "", "", {}
    for detail in status.details:
        if detail.Is(status_pb2.FieldViolation.DESCRIPTOR):
            violation = status_pb2.FieldViolation()
            detail.Unpack(violation)
            field = violation.field
        elif detail.type_url == ERROR_INFO:
            info = status_pb2.ErrorInfo.FromString(detail.value)
            if info.domain == "lpv.v1":
                reason, metadata = info.reason, dict(info.metadata)
    return Error(_CODES.get(status.code, grpc.StatusCode.UNKNOWN), status.message, field, reason, metadata)


def from_call(error: Any) -> Error:
    """Of a grpc.RpcError, which is a call, or of grpc.aio's AioRpcError."""
    message = error.details() or error.code().name
    metadata: Iterable[Any] = error.trailing_metadata() or ()
    for key, value in metadata:
        if key == DETAILS:
            refusal = from_status(status_pb2.Status.FromString(value))
            return Error(error.code(), message, refusal.field, refusal.reason, refusal.metadata)
    return Error(error.code(), message)
