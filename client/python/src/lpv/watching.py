"""Streams that last: volumes, frames, and what changes in the scene. They keep PROTOCOL.md, Credit and Reconnecting:
a result is acknowledged when the next one is asked for, which is when it has been applied; a stream that breaks is
opened again; results below the newest (epoch, revision) are dropped."""

from __future__ import annotations

import random
from typing import Any, Generic, TypeVar

import grpc

from lpv import errors
from lpv.compact import Malformed
from lpv.results import Frame, FrameParts, Volume, VolumeParts
from lpv.transport import Stream, Transport
from lpv.v1 import geometry_pb2, result_pb2, scene_pb2, session_pb2, volume_pb2

R = TypeVar("R", Volume, Frame)
SILENCE = 3.0  # heartbeats come every second


class Pause:
    """Random between 100 ms and a bound that doubles with every attempt in which nothing arrived."""

    def __init__(self) -> None:
        self.attempts = 0

    def seconds(self) -> float:
        self.attempts += 1
        return random.uniform(0.1, min(0.1 * 2**self.attempts, 2.0))


class _Watch:
    """A stream that is opened again until it is closed, or ends for good."""

    def __init__(self, transport: Transport) -> None:
        self._transport = transport
        self._stream: Stream | None = None
        self._pause = Pause()
        self._closed = False
        #: times that the stream was opened again
        self.reopened = 0

    def close(self) -> None:
        """Ends the iteration, also one that waits in another thread."""
        self._closed = True
        if self._stream is not None:
            self._stream.cancel()

    def _open(self) -> Stream:
        raise NotImplementedError

    async def _message(self) -> Any:
        """The next message. StopAsyncIteration when closed; Error where opening again would be useless."""
        while not self._closed:
            if self._stream is None:
                self._stream = self._open()
            try:
                message = await self._stream.read(SILENCE)
                if message is not None:
                    self._pause.attempts = 0
                    return message
            except errors.Error as error:
                if not self._closed and error.code not in errors.REOPEN:
                    self._closed = True
                    raise
            self._stream.cancel()
            self._stream = None
            if not self._closed:
                self.reopened += 1
                await self._transport.sleep(self._pause.seconds())
        self.close()  # the stream, where another thread has closed this while it was opened
        raise StopAsyncIteration


class _Results(_Watch, Generic[R]):
    """Results with credit."""

    def __init__(self, transport: Transport, method: Any, request: Any, update: Any) -> None:
        super().__init__(transport)
        self._method, self._request, self._update = method, request, update
        self._parts: Any = None
        self._applied: int | None = None  # what the caller has, and has not been acknowledged
        self._newest = (0, 0)
        #: results given out, below the newest seen, and malformed or with another checksum
        self.results = self.discarded = self.faults = 0
        #: name of the open stream, for Session.pick
        self.subscriber = ""

    def __aiter__(self) -> _Results[R]:
        return self

    async def __anext__(self) -> R:
        self._acknowledge(self._applied)
        self._applied = None
        while True:
            event = (await self._message()).event
            kind = event.WhichOneof("event")
            if kind == "subscribed":
                self.subscriber = event.subscribed.subscriber
            elif kind == "part":
                result = self._take(event.part)
                if result is not None:
                    return result

    def _open(self) -> Stream:
        self._applied = None
        self._parts = self._new_parts()
        stream = self._transport.open(self._method)
        stream.write(self._request())
        return stream

    def _new_parts(self) -> Any:
        raise NotImplementedError

    def _take(self, part: Any) -> R | None:
        try:
            result: R | None = self._parts.add(part)
        except Malformed:
            self.faults += 1
            if getattr(self._parts, "whole", False):  # nothing better will come: a format that is not known here
                self.close()
                raise
            self._acknowledge(part.result_id, request_key_frame=True)
            return None
        if result is None:
            return None
        order = (result.header.result.epoch, result.header.result.revision)
        if order < self._newest:
            self.discarded += 1
            self._acknowledge(result.header.result.result_id)
            return None
        self._newest, self._applied = order, result.header.result.result_id
        self.results += 1
        return result

    def _acknowledge(self, result_id: int | None, **more: Any) -> None:
        if result_id is not None:
            self._say(acknowledge=result_pb2.Acknowledge(result_id=result_id), **more)

    def _say(self, **fields: Any) -> None:
        stream = self._stream
        if stream is not None:
            stream.write(self._update(result_pb2.SubscriberUpdate(**fields)))


class VolumeStream(_Results[Volume]):
    def __init__(self, transport: Transport, subscription: volume_pb2.VolumeSubscription) -> None:
        super().__init__(transport, transport.results.StreamVolume,
                         lambda: result_pb2.StreamVolumeRequest(subscription=subscription),
                         lambda update: result_pb2.StreamVolumeRequest(update=update))

    def _new_parts(self) -> VolumeParts:
        return VolumeParts()

    def request_key_frame(self) -> None:
        """The next volume is a whole one."""
        self._say(request_key_frame=True)


class FrameStream(_Results[Frame]):
    def __init__(self, transport: Transport, subscription: result_pb2.FrameSubscription) -> None:
        super().__init__(transport, transport.results.StreamFrames,
                         lambda: result_pb2.StreamFramesRequest(subscription=subscription),
                         lambda update: result_pb2.StreamFramesRequest(update=update))
        self._subscription = subscription

    def _new_parts(self) -> FrameParts:
        return FrameParts()

    def set_camera(self, camera: geometry_pb2.Camera) -> int:
        """Moves this subscriber's camera, also for streams opened later. The sequence that frames showing it echo."""
        update = result_pb2.CameraUpdate(camera=camera, sequence=self._subscription.camera.sequence + 1)
        self._subscription.camera.CopyFrom(update)
        self._subscription.camera_name = ""
        self._say(camera=update)
        return update.sequence

    def set_size(self, width: int, height: int) -> None:
        self._subscription.width, self._subscription.height = width, height
        self._say(width=width, height=height)


class SceneStream(_Watch):
    """Snapshots, changes and presence (WatchSceneResponse), in order and without gaps, also where the stream broke."""

    def __init__(self, transport: Transport, session: str, since_revision: int,
                 client: session_pb2.ClientIdentity | None) -> None:
        super().__init__(transport)
        self._request = scene_pb2.WatchSceneRequest(session=session, since_revision=since_revision, client=client)

    def __aiter__(self) -> SceneStream:
        return self

    async def __anext__(self) -> scene_pb2.WatchSceneResponse:
        while True:
            response: scene_pb2.WatchSceneResponse = await self._message()
            kind = response.WhichOneof("event")
            if kind == "snapshot" and not response.snapshot.more:
                self._reached(response.snapshot.revision, response.snapshot.epoch)
            elif kind == "change" and not response.change.more:
                self._reached(response.change.last_revision, response.change.epoch)
            if kind in ("snapshot", "change", "presence"):
                return response

    def _reached(self, revision: int, epoch: int) -> None:
        self._request.since_revision, self._request.since_epoch = revision, epoch

    def _open(self) -> Stream:
        return self._transport.open(self._transport.scene.WatchScene, self._request)
