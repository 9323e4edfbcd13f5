"""The client for programs and notebooks without an event loop: every method of lpv.aio, waiting for its answer."""

from __future__ import annotations

import functools
from typing import Any, Callable, Concatenate, Coroutine, Generic, Iterator, ParamSpec, TypeVar

import grpc

from lpv import aio
from lpv.editing import Pending
from lpv.results import Frame, Volume
from lpv.transport import OPTIONS, Blocking, credentials, now
from lpv.v1 import geometry_pb2, scene_pb2, session_pb2
from lpv.watching import FrameStream, SceneStream, VolumeStream

A = TypeVar("A")
P = ParamSpec("P")
T = TypeVar("T")


class _Over(Generic[A]):
    """Something of lpv.aio whose transport blocks."""

    def __init__(self, calls: A) -> None:
        self._calls = calls


def _waits(method: Callable[Concatenate[A, P], Coroutine[Any, Any, T]]) -> Callable[Concatenate[_Over[A], P], T]:
    """The same method, waiting for its outcome."""

    @functools.wraps(method)
    def call(self: _Over[A], /, *args: P.args, **kwargs: P.kwargs) -> T:
        return now(method(self._calls, *args, **kwargs))

    return call


def connect(address: str = "localhost:50051", *, token: str = "", token_file: str = "", tls: bool = False, ca: str = "",
            certificate: str = "", key: str = "", timeout: float = 30.0) -> Client:
    """As lpv.aio.connect."""
    secure = tls or ca or certificate or key
    channel = (grpc.secure_channel(address, credentials(ca, certificate, key), options=OPTIONS) if secure
               else grpc.insecure_channel(address, options=OPTIONS))
    return Client(aio.Client(Blocking(channel, aio.read_token(token, token_file), timeout)))


class Client(_Over[aio.Client]):
    """A server."""

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends what is open over this connection."""
        self._calls._transport.channel.close()

    info = _waits(aio.Client.info)
    stats = _waits(aio.Client.stats)
    sessions = _waits(aio.Client.sessions)

    def session(self, name: str) -> Session:
        """By id or "sessions/{id}". Asks nothing of the server."""
        return Session(self._calls.session(name))

    def create_session(self, session_id: str = "", *, grid: int | None = None, **settings: Any) -> Session:
        """As scene.settings. Sent again after a broken connection it is the same session."""
        return Session(now(self._calls.create_session(session_id, grid=grid, **settings)))

    def import_session(self, file: bytes, session_id: str = "") -> Session:
        """From the bytes that Session.export gave."""
        return Session(now(self._calls.import_session(file, session_id)))


class Editor(_Over[aio.Editor]):
    """A member of a session. `with session.join() as editor:` waits for the answers at its end."""

    def __enter__(self) -> Editor:
        return self

    def __exit__(self, failed: object, *_: object) -> None:
        if failed is None:
            self.close()
        else:
            self.abandon()

    send = _waits(aio.Editor.send)
    apply = _waits(aio.Editor.apply)
    drain = _waits(aio.Editor.drain)
    undo = _waits(aio.Editor.undo)
    redo = _waits(aio.Editor.redo)
    lock = _waits(aio.Editor.lock)
    present = _waits(aio.Editor.present)
    leave = _waits(aio.Editor.leave)

    def close(self, timeout: float | None = None) -> None:
        """Waits for the answers and ends the stream. The member stays: Session.resume(saved()) goes on with it."""
        now(self._calls.close(timeout))

    def abandon(self) -> None:
        """Ends the stream without waiting. What is not answered may be applied or not; saved() has it."""
        self._calls.abandon()

    def saved(self) -> dict[str, Any]:
        """All that Session.resume needs, in another process too; JSON holds it."""
        return self._calls.saved()

    @property
    def identity(self) -> session_pb2.ClientIdentity:
        return self._calls.identity

    @property
    def sequence(self) -> int:
        """Of the last edit, undo or redo sent."""
        return self._calls.sequence

    @property
    def revision(self) -> int:
        """The highest one acknowledged."""
        return self._calls.revision

    @property
    def reopened(self) -> int:
        """Times that the stream of edits was opened again."""
        return self._calls.reopened

    @property
    def refused(self) -> list[Any]:
        """Why edits were refused, in order: lpv.Error."""
        return self._calls.refused


S = TypeVar("S", bound="_Iterated[Any, Any]")


class _Iterated(Generic[A, T]):
    """A stream of lpv.aio as an ordinary iterator. `watch` has its counters."""

    def __init__(self, watch: A) -> None:
        self.watch = watch

    def __iter__(self) -> Iterator[T]:
        return self

    def __next__(self) -> T:
        try:
            answer: T = now(self.watch.__anext__())  # type: ignore[attr-defined]
            return answer
        except StopAsyncIteration:
            raise StopIteration from None

    def __enter__(self: S) -> S:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()  # of a loop that was left

    def close(self) -> None:
        """Ends the iteration, also one that waits in another thread."""
        self.watch.close()  # type: ignore[attr-defined]


class Volumes(_Iterated[VolumeStream, Volume]):
    def request_key_frame(self) -> None:
        """The next volume is a whole one."""
        self.watch.request_key_frame()


class Frames(_Iterated[FrameStream, Frame]):
    def set_camera(self, camera: geometry_pb2.Camera) -> int:
        """Moves this subscriber's camera. The sequence that frames showing it echo."""
        return self.watch.set_camera(camera)

    def set_size(self, width: int, height: int) -> None:
        self.watch.set_size(width, height)


class Changes(_Iterated[SceneStream, scene_pb2.WatchSceneResponse]):
    pass


class Session(_Over[aio.Session]):
    """One grid and one scene."""

    @property
    def name(self) -> str:
        """"sessions/{id}"."""
        return self._calls.name

    @property
    def owner_token(self) -> str:
        """From create_session and import_session, where the server asks for tokens; shown once."""
        return self._calls.owner_token

    info = _waits(aio.Session.info)
    fit = _waits(aio.Session.fit)
    delete = _waits(aio.Session.delete)
    export = _waits(aio.Session.export)
    apply = _waits(aio.Session.apply)
    lights = _waits(aio.Session.lights)
    surfaces = _waits(aio.Session.surfaces)
    cameras = _waits(aio.Session.cameras)
    upload = _waits(aio.Session.upload)
    volume = _waits(aio.Session.volume)
    frame = _waits(aio.Session.frame)
    probe = _waits(aio.Session.probe)
    pick = _waits(aio.Session.pick)
    create_token = _waits(aio.Session.create_token)
    tokens = _waits(aio.Session.tokens)
    revoke_token = _waits(aio.Session.revoke_token)

    def update(self, *, grid: int | None = None, **settings: Any) -> session_pb2.Session:
        """Changes these settings and no others."""
        return now(self._calls.update(grid=grid, **settings))

    def join(self, display_name: str = "") -> Editor:
        """A member, whose edits are applied once and can be undone."""
        return Editor(now(self._calls.join(display_name)))

    def resume(self, saved: dict[str, Any]) -> Editor:
        """Goes on as the member that Editor.saved told of: what was not answered is sent again."""
        return Editor(now(self._calls.resume(saved)))

    def volumes(self, format: str = "compact", **wanted: Any) -> Volumes:
        """As lpv.aio.Session.volumes."""
        return Volumes(self._calls.volumes(format, **wanted))

    def frames(self, width: int = 0, height: int = 0, **wanted: Any) -> Frames:
        """As lpv.aio.Session.frames."""
        return Frames(self._calls.frames(width, height, **wanted))

    def changes(self, since_revision: int = 0, editor: Editor | None = None) -> Changes:
        """As lpv.aio.Session.changes."""
        return Changes(self._calls.changes(since_revision, None if editor is None else editor._calls))


__all__ = ["Changes", "Client", "Editor", "Frames", "Pending", "Session", "Volumes", "connect"]
