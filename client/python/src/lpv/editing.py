"""A member of a session: edits in order, each applied once whatever becomes of the connection or the server
(PROTOCOL.md, Sequences and idempotency)."""

from __future__ import annotations

import base64
import collections
import concurrent.futures
import threading
from typing import Any, Generator, Sequence

import grpc
from google.protobuf import duration_pb2

from lpv import errors
from lpv.transport import Stream, Transport
from lpv.v1 import scene_pb2, session_pb2
from lpv.watching import SILENCE, Pause

MOST_UNANSWERED = 256  # the server, too, stops reading there
ATTEMPTS = 4
_UNKNOWN = (grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.UNKNOWN)  # whether the call was carried out is not known


class Pending:
    """An edit under way. Blocking: result(); in a coroutine: await it. Both give the EditAck, or raise the refusal."""

    def __init__(self, sequence: int) -> None:
        self.sequence = sequence
        self.future: concurrent.futures.Future[scene_pb2.EditAck] = concurrent.futures.Future()
        self.future.set_running_or_notify_cancel()  # who waits may be cancelled, the edit is not

    def result(self, timeout: float | None = None) -> scene_pb2.EditAck:
        return self.future.result(timeout)

    def done(self) -> bool:
        return self.future.done()

    def __await__(self) -> Generator[Any, None, scene_pb2.EditAck]:
        import asyncio

        return asyncio.wrap_future(self.future).__await__()


class Editor:
    """See Session.join. One thread or task at a time may edit with it."""

    def __init__(self, transport: Transport, session: str, identity: session_pb2.ClientIdentity, sequence: int = 0,
                 unanswered: Sequence[scene_pb2.Edit] = ()) -> None:
        self._transport, self.session, self.identity = transport, session, identity
        #: of the last edit, undo or redo sent
        self.sequence = sequence
        #: the highest one acknowledged
        self.revision = 0
        #: times that the stream of edits was opened again
        self.reopened = 0
        #: why edits were refused, in order; those beyond max_edits_per_second, too
        self.refused: list[errors.Error] = []
        self._lock = threading.Lock()
        self._unanswered: collections.OrderedDict[int, tuple[scene_pb2.Edit, Pending]] = collections.OrderedDict()
        self._stream: Stream | None = None
        self._running = self._closing = False
        self._ended: errors.Error | None = None
        for edit in unanswered:
            self._queue(edit)
        if unanswered:
            self._begin()

    def saved(self) -> dict[str, Any]:
        """All that Session.resume needs, in another process too: identity, sequence and the edits that were not
        answered. JSON holds it. The secret in it lets its bearer edit as this member, where access tokens let it edit
        at all."""
        with self._lock:
            edits = [base64.b64encode(edit.SerializeToString()).decode() for edit, _ in self._unanswered.values()]
            return {"session": self.session, "client_id": self.identity.client_id, "secret": self.identity.secret,
                    "sequence": self.sequence, "unanswered": edits}

    async def send(self, *operations: scene_pb2.Operation, undo_group: str = "",
                   expected_revision: int | None = None) -> Pending:
        """Sends an edit without waiting for its answer, but for one of the 256 before it. Consecutive edits of one
        undo_group are one undo step."""
        while len(self._unanswered) >= MOST_UNANSWERED and self._ended is None and not self._closing:
            with self._lock:
                oldest = [pending.future for _, pending in list(self._unanswered.values())[:1]]
            await self._transport.wait(oldest, None)
        edit = scene_pb2.Edit(operations=operations, undo_group=undo_group, expected_revision=expected_revision)
        with self._lock:
            if self._ended is not None:
                raise self._ended
            if self._closing:
                raise ValueError("the editor is closed")
            self.sequence += 1
            edit.sequence = self.sequence
            pending = self._queue(edit)
            if self._stream is not None:
                self._stream.write(scene_pb2.StreamEditsRequest(edit=edit))
        self._begin()
        return pending

    async def apply(self, *operations: scene_pb2.Operation, undo_group: str = "",
                    expected_revision: int | None = None, timeout: float | None = None) -> scene_pb2.EditAck:
        """Sends an edit and waits for its answer. Error where it was refused; nothing has changed then."""
        pending = await self.send(*operations, undo_group=undo_group, expected_revision=expected_revision)
        if not await self._transport.wait([pending.future], timeout or self._transport.timeout):
            raise errors.Error(grpc.StatusCode.DEADLINE_EXCEEDED, f"edit {pending.sequence} is not answered yet")
        return pending.result()

    async def drain(self, timeout: float | None = None) -> None:
        """Until every edit is answered. Those that were refused are in `refused`."""
        with self._lock:
            waited = [pending.future for _, pending in self._unanswered.values()]
        if not await self._transport.wait(waited, timeout or self._transport.timeout):
            raise errors.Error(grpc.StatusCode.DEADLINE_EXCEEDED, f"{len(self._unanswered)} edits are not answered yet")
        if self._ended is not None:
            raise self._ended

    async def undo(self) -> scene_pb2.EditAck:
        """Takes this member's newest step back. EditAck.skipped_fields names what others have written since."""
        return await self._step(self._transport.scene.Undo, scene_pb2.UndoRequest)

    async def redo(self) -> scene_pb2.EditAck:
        return await self._step(self._transport.scene.Redo, scene_pb2.RedoRequest)

    async def lock(self, objects: Sequence[str], seconds: int) -> None:
        """Keeps others from changing lights and surfaces for 1 to 60 s; 0 releases them."""
        await self._transport.unary(self._transport.scene.LockObjects, scene_pb2.LockObjectsRequest(
            session=self.session, client=self.identity, objects=objects, ttl=duration_pb2.Duration(seconds=seconds)))

    async def present(self, presence: session_pb2.Presence) -> None:
        """Name, colour, camera and selection, as the other members see them."""
        await self._transport.unary(self._transport.sessions.UpdatePresence, session_pb2.UpdatePresenceRequest(
            session=self.session, client=self.identity, presence=presence))

    async def leave(self) -> None:
        """Gives the identity back, when every edit is answered. The edits stay."""
        await self.close()
        await self._transport.unary(self._transport.sessions.LeaveSession,
                                    session_pb2.LeaveSessionRequest(session=self.session, client=self.identity))

    async def close(self, timeout: float | None = None) -> None:
        """Waits for the answers and ends the stream. The member stays: Session.resume(saved()) goes on with it."""
        try:
            await self.drain(timeout)
        finally:
            self.abandon()

    def abandon(self) -> None:
        """Ends the stream without waiting. What is not answered may be applied or not; saved() has it."""
        self._closing = True
        stream = self._stream
        if stream is not None:
            stream.cancel()

    async def __aenter__(self) -> Editor:
        return self

    async def __aexit__(self, failed: object, *_: object) -> None:
        if failed is None:
            await self.close()
        else:
            self.abandon()

    async def _step(self, method: Any, kind: Any) -> scene_pb2.EditAck:
        await self.drain()
        with self._lock:
            self.sequence += 1
            request = kind(session=self.session, client=self.identity, sequence=self.sequence)
        pause = Pause()
        while True:
            try:
                ack: scene_pb2.EditAck = (await self._transport.unary(method, request)).ack
                self.revision = max(self.revision, ack.revision)
                return ack
            except errors.Error as error:
                if error.code not in _UNKNOWN or pause.attempts == ATTEMPTS:
                    raise
                await self._transport.sleep(pause.seconds())

    def _queue(self, edit: scene_pb2.Edit) -> Pending:
        pending = Pending(edit.sequence)
        self._unanswered[edit.sequence] = (edit, pending)
        return pending

    def _begin(self) -> None:
        if not self._running:
            self._running = True
            self._transport.start(self._run())

    async def _run(self) -> None:
        pause = Pause()
        while not self._closing:
            try:
                await self._attempt(pause)
            except errors.Error as error:
                if error.code not in errors.REOPEN and not self._closing:
                    return self._end(error)
            if not self._closing:
                self.reopened += 1
                await self._transport.sleep(pause.seconds())
        self._tell(errors.Error(grpc.StatusCode.CANCELLED, "the editor was closed before this edit was answered"))

    async def _attempt(self, pause: Pause) -> None:
        """One stream: all that is unanswered, in order, then what is sent meanwhile."""
        stream = self._transport.open(self._transport.scene.StreamEdits)
        with self._lock:
            stream.write(scene_pb2.StreamEditsRequest(session=self.session, client=self.identity))
            for edit, _ in self._unanswered.values():
                stream.write(scene_pb2.StreamEditsRequest(edit=edit))
            self._stream = stream
        try:
            while (response := await stream.read(SILENCE)) is not None:
                pause.attempts = 0
                if response.WhichOneof("event") == "ack" and not self._answered(response.ack):
                    return
        finally:
            self._stream = None
            stream.cancel()

    def _answered(self, ack: scene_pb2.EditAck) -> bool:
        """False where the outcome is not known: it is asked for again, and what came behind it with it."""
        if ack.status.code == grpc.StatusCode.UNAVAILABLE.value[0]:
            return False
        with self._lock:
            _, pending = self._unanswered.pop(ack.sequence, (None, None))
        self.revision = max(self.revision, ack.revision)
        if pending is None:
            return True
        if ack.status.code:
            refusal = errors.from_status(ack.status)
            self.refused.append(refusal)
            pending.future.set_exception(refusal)
        else:
            pending.future.set_result(ack)
        return True

    def _end(self, error: errors.Error) -> None:
        with self._lock:
            self._ended = error
        self._tell(error)

    def _tell(self, error: errors.Error) -> None:
        """Everybody who waits."""
        with self._lock:
            unanswered = list(self._unanswered.values())
        for _, pending in unanswered:
            pending.future.set_exception(error)
