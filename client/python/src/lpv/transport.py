"""Calls over one channel, in two kinds with one interface: Blocking and Async. What this package does is written once,
as coroutines over this interface; over a Blocking transport they never wait for an event loop, and now() runs them."""

from __future__ import annotations

import abc
import asyncio
import concurrent.futures
import queue
import threading
import time
from typing import Any, AsyncIterator, Coroutine, Iterable, TypeVar

import grpc
import grpc.aio

from lpv import errors
from lpv.v1 import blob_pb2_grpc, result_pb2_grpc, scene_pb2_grpc, server_pb2_grpc, session_pb2_grpc

T = TypeVar("T")
OPTIONS = [
    # A host that vanishes does not close its connections: pings detect that. 10 s is the shortest that gRPC allows.
    ("grpc.keepalive_time_ms", 10000),
    ("grpc.keepalive_timeout_ms", 5000),
    ("grpc.enable_http_proxy", 0),
    ("grpc.initial_reconnect_backoff_ms", 100),
    ("grpc.max_reconnect_backoff_ms", 2000),
]
FIRST_ATTEMPTS = 1.0  # s, four or so by the backoff above: gRPC 1.51 may take one that is under way for one that failed
QUEUED = 64  # messages read ahead of a slow reader; gRPC stops the server beyond


def now(work: Coroutine[Any, Any, T]) -> T:
    """The result of a coroutine over a Blocking transport: nothing in it suspends."""
    try:
        work.send(None)
    except StopIteration as end:
        result: T = end.value
        return result
    work.close()
    raise RuntimeError("a coroutine over a blocking transport waited for an event loop")


class Stream(abc.ABC):
    """One open call that answers with many messages."""

    @abc.abstractmethod
    def write(self, request: Any) -> None:
        """Queues a message; never waits."""

    @abc.abstractmethod
    def finish(self) -> None:
        """Closes the client's side behind what was written."""

    @abc.abstractmethod
    async def read(self, silence: float) -> Any:
        """The next message, or None where the stream ended with OK. Error where it ended otherwise, or where nothing
        came for `silence` seconds."""

    @abc.abstractmethod
    def cancel(self) -> None:
        """Ends the call. Safe from any thread of a blocking client."""


class Transport(abc.ABC):
    def __init__(self, channel: Any, token: str, timeout: float) -> None:
        self.channel = channel
        self.timeout = timeout
        self.reached = False
        self.metadata: tuple[tuple[str, str], ...] = (("authorization", f"Bearer {token}"),) if token else ()
        self.server: Any = server_pb2_grpc.ServerServiceStub(channel)
        self.sessions: Any = session_pb2_grpc.SessionServiceStub(channel)
        self.blobs: Any = blob_pb2_grpc.BlobServiceStub(channel)
        self.scene: Any = scene_pb2_grpc.SceneServiceStub(channel)
        self.results: Any = result_pb2_grpc.ResultServiceStub(channel)

    @abc.abstractmethod
    async def unary(self, method: Any, request: Any, timeout: float | None = None) -> Any:
        """One question and its answer. `request` may be a list of messages where the method takes a stream."""

    @abc.abstractmethod
    def parts(self, method: Any, request: Any, timeout: float | None = None) -> AsyncIterator[Any]:
        """The messages of an answer in parts."""

    @abc.abstractmethod
    def open(self, method: Any, request: Any = None) -> Stream:
        """A stream without an end of its own; with `request` one that only the server speaks on."""

    @abc.abstractmethod
    async def sleep(self, seconds: float) -> None: ...

    @abc.abstractmethod
    async def wait(self, futures: Iterable[concurrent.futures.Future[Any]], timeout: float | None) -> bool:
        """Until all are done; false where the time is over before."""

    @abc.abstractmethod
    def start(self, work: Coroutine[Any, Any, None]) -> None:
        """Runs it beside the caller."""


class Blocking(Transport):
    def _reach(self) -> None:
        """Before the first call: with or without a connection."""
        if self.reached:
            return
        self.reached = True
        ready = grpc.channel_ready_future(self.channel)
        try:
            ready.result(timeout=min(FIRST_ATTEMPTS, self.timeout))
        except grpc.FutureTimeoutError:
            ready.cancel()

    async def unary(self, method: Any, request: Any, timeout: float | None = None) -> Any:
        self._reach()
        sent = iter(request) if isinstance(request, list) else request
        try:
            return method(sent, timeout=timeout or self.timeout, metadata=self.metadata)
        except grpc.RpcError as error:
            raise errors.from_call(error) from None

    async def parts(self, method: Any, request: Any, timeout: float | None = None) -> AsyncIterator[Any]:
        self._reach()
        try:
            for part in method(request, timeout=timeout or self.timeout, metadata=self.metadata):
                yield part
        except grpc.RpcError as error:
            raise errors.from_call(error) from None

    def open(self, method: Any, request: Any = None) -> Stream:
        self._reach()
        return _BlockingStream(method, request, self.metadata)

    async def sleep(self, seconds: float) -> None:
        time.sleep(seconds)

    async def wait(self, futures: Iterable[concurrent.futures.Future[Any]], timeout: float | None) -> bool:
        return not concurrent.futures.wait(futures, timeout).not_done

    def start(self, work: Coroutine[Any, Any, None]) -> None:
        threading.Thread(target=now, args=(work,), daemon=True).start()


class _BlockingStream(Stream):
    """A thread reads ahead, so that read() can tell a silent stream from a slow one."""

    _END = object()

    def __init__(self, method: Any, request: Any, metadata: Any) -> None:
        self._requests: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self._answers: queue.Queue[Any] = queue.Queue(QUEUED)
        self._closed = False
        sent = iter(self._requests.get, self._END) if request is None else request
        self._call = method(sent, metadata=metadata)
        threading.Thread(target=self._pump, daemon=True).start()

    def _pump(self) -> None:
        try:
            for answer in self._call:
                self._offer(answer)
            self._offer(None)
        except grpc.RpcError as error:
            self._offer(errors.from_call(error))
        self._requests.put(self._END)  # lets go of gRPC's thread that waits for requests

    def _offer(self, answer: Any) -> None:
        while not self._closed:
            try:
                return self._answers.put(answer, timeout=0.5)
            except queue.Full:
                continue

    def write(self, request: Any) -> None:
        self._requests.put(request)

    def finish(self) -> None:
        self._requests.put(self._END)

    async def read(self, silence: float) -> Any:
        try:
            answer = self._answers.get(timeout=silence)
        except queue.Empty:
            self.cancel()
            raise _silent(silence) from None
        if isinstance(answer, errors.Error):
            raise answer
        return answer

    def cancel(self) -> None:
        self._closed = True
        self._call.cancel()
        try:
            self._answers.put_nowait(_cancelled())  # wakes who reads
        except queue.Full:
            pass


class Async(Transport):
    def __init__(self, channel: Any, token: str, timeout: float) -> None:
        super().__init__(channel, token, timeout)
        self._tasks: set[asyncio.Task[None]] = set()

    async def _reach(self) -> None:
        """Before the first call: with or without a connection."""
        if self.reached:
            return
        self.reached = True
        try:
            await asyncio.wait_for(self.channel.channel_ready(), min(FIRST_ATTEMPTS, self.timeout))
        except asyncio.TimeoutError:
            pass

    async def unary(self, method: Any, request: Any, timeout: float | None = None) -> Any:
        await self._reach()
        sent = iter(request) if isinstance(request, list) else request
        try:
            return await method(sent, timeout=timeout or self.timeout, metadata=self.metadata)
        except grpc.RpcError as error:
            raise errors.from_call(error) from None

    async def parts(self, method: Any, request: Any, timeout: float | None = None) -> AsyncIterator[Any]:
        await self._reach()
        try:
            async for part in method(request, timeout=timeout or self.timeout, metadata=self.metadata):
                yield part
        except grpc.RpcError as error:
            raise errors.from_call(error) from None

    def open(self, method: Any, request: Any = None) -> Stream:
        return _AsyncStream(method, request, self.metadata)

    async def sleep(self, seconds: float) -> None:
        await asyncio.sleep(seconds)

    async def wait(self, futures: Iterable[concurrent.futures.Future[Any]], timeout: float | None) -> bool:
        waited = [asyncio.wrap_future(future) for future in futures]
        if not waited:
            return True
        _, late = await asyncio.wait(waited, timeout=timeout)
        for one in waited:
            if one.done() and not one.cancelled():
                one.exception()  # told to whoever asks for the outcome
        return not late

    def start(self, work: Coroutine[Any, Any, None]) -> None:
        task = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)  # a loop holds its tasks weakly
        task.add_done_callback(self._tasks.discard)


class _AsyncStream(Stream):
    def __init__(self, method: Any, request: Any, metadata: Any) -> None:
        self._requests: asyncio.Queue[Any] = asyncio.Queue()
        self._closed = False
        self._call = method(self._sent() if request is None else request, metadata=metadata)

    async def _sent(self) -> AsyncIterator[Any]:
        while (request := await self._requests.get()) is not None:
            yield request

    def write(self, request: Any) -> None:
        self._requests.put_nowait(request)

    def finish(self) -> None:
        self._requests.put_nowait(None)

    async def read(self, silence: float) -> Any:
        try:
            answer = await asyncio.wait_for(self._call.read(), silence)
        except asyncio.TimeoutError:
            self.cancel()
            raise _silent(silence) from None
        except asyncio.CancelledError:
            if not self._closed:
                raise  # whoever reads is cancelled, not the call
            raise _cancelled() from None
        except grpc.RpcError as error:
            raise errors.from_call(error) from None
        return None if answer is grpc.aio.EOF else answer

    def cancel(self) -> None:
        self._closed = True
        self.finish()
        self._call.cancel()


def _silent(seconds: float) -> errors.Error:
    return errors.Error(grpc.StatusCode.UNAVAILABLE, f"nothing came from the server for {seconds:g} s")


def _cancelled() -> errors.Error:
    return errors.Error(grpc.StatusCode.CANCELLED, "the stream was ended by its client")


def credentials(ca: str, certificate: str, key: str) -> grpc.ChannelCredentials:
    """Of files; those that are "" are left out."""
    if bool(certificate) != bool(key):
        raise ValueError("a client certificate needs its key and the key its certificate; give both or none")

    def content(path: str) -> bytes | None:
        if not path:
            return None
        with open(path, "rb") as file:
            return file.read()

    return grpc.ssl_channel_credentials(content(ca), content(key), content(certificate))
