"""The client as coroutines: `async with lpv.aio.connect(...)`. lpv.blocking has the same for programs without an event
loop, over the same code."""

from __future__ import annotations

import uuid
from typing import Any, Sequence

import grpc.aio
import numpy as np
from google.protobuf import duration_pb2, field_mask_pb2
from numpy.typing import ArrayLike

from lpv import scene
from lpv.editing import Editor, Pending
from lpv.results import Frame, FrameParts, Probe, Volume, VolumeParts
from lpv.transport import OPTIONS, Async, Transport, credentials
from lpv.v1 import blob_pb2, geometry_pb2, result_pb2, scene_pb2, server_pb2, session_pb2, volume_pb2
from lpv.watching import FrameStream, SceneStream, VolumeStream

__all__ = ["Client", "Editor", "FrameStream", "Pending", "SceneStream", "Session", "VolumeStream", "connect"]
PART = 1 << 19  # a message, with what is around its data, is at most 1 MiB
_MAX_POINTS = 16384
_MAX_POINTS_AROUND = 256


def connect(address: str = "localhost:50051", *, token: str = "", token_file: str = "", tls: bool = False, ca: str = "",
            certificate: str = "", key: str = "", timeout: float = 30.0) -> Client:
    """A connection, made inside a running event loop; the first call uses the network. With `tls`, or files of an
    authority (`ca`) or of the client (`certificate` and `key`), over TLS; `ca` left out: the authorities that gRPC
    brings along. `timeout`: of one call, seconds."""
    secure = tls or ca or certificate or key
    channel = (grpc.aio.secure_channel(address, credentials(ca, certificate, key), options=OPTIONS) if secure
               else grpc.aio.insecure_channel(address, options=OPTIONS))
    return Client(Async(channel, read_token(token, token_file), timeout))


def read_token(token: str, token_file: str) -> str:
    if not token_file:
        return token
    with open(token_file, encoding="utf-8") as file:
        return file.readline().strip()


class Client:
    """A server."""

    def __init__(self, transport: Transport) -> None:
        self._transport = transport

    async def __aenter__(self) -> Client:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def close(self) -> None:
        await self._transport.channel.close()

    async def info(self) -> server_pb2.GetServerInfoResponse:
        """Version, device and limits."""
        return await self._transport.unary(self._transport.server.GetServerInfo, server_pb2.GetServerInfoRequest())

    async def stats(self) -> server_pb2.GetStatsResponse:
        return await self._transport.unary(self._transport.server.GetStats, server_pb2.GetStatsRequest())

    async def sessions(self) -> list[session_pb2.Session]:
        """Those that this caller may see."""
        return await _listing(self._transport, self._transport.sessions.ListSessions, session_pb2.ListSessionsRequest(),
                              "sessions")

    def session(self, name: str) -> Session:
        """By id or "sessions/{id}". Asks nothing of the server."""
        return Session(self._transport, name if name.startswith("sessions/") else f"sessions/{name}")

    async def create_session(self, session_id: str = "", *, grid: int | None = None, **settings: Any) -> Session:
        """As scene.settings. Sent again after a broken connection it is the same session."""
        response = await self._transport.unary(self._transport.sessions.CreateSession, session_pb2.CreateSessionRequest(
            session_id=session_id, settings=scene.settings(grid, **settings), request_id=uuid.uuid4().hex))
        return Session(self._transport, response.session.name, response.owner_token)

    async def import_session(self, file: bytes, session_id: str = "") -> Session:
        """From the bytes that Session.export gave."""
        parts = [session_pb2.ImportSessionRequest(data=file[at:at + PART]) for at in range(0, max(len(file), 1), PART)]
        parts[0].session_id = session_id
        response = await self._transport.unary(self._transport.sessions.ImportSession, parts)
        return Session(self._transport, response.session.name, response.owner_token)


class Session:
    """One grid and one scene."""

    def __init__(self, transport: Transport, name: str, owner_token: str = "") -> None:
        self._transport = transport
        #: "sessions/{id}"
        self.name = name
        #: from create_session and import_session, where the server asks for tokens; shown once
        self.owner_token = owner_token

    async def info(self) -> session_pb2.Session:
        response = await self._transport.unary(self._transport.sessions.GetSession,
                                               session_pb2.GetSessionRequest(name=self.name))
        return response.session

    async def update(self, *, grid: int | None = None, **settings: Any) -> session_pb2.Session:
        """Changes these settings and no others."""
        paths = [f"settings.{name}" for name in (*(("grid",) if grid is not None else ()), *settings)]
        wanted = session_pb2.Session(name=self.name, settings=scene.settings(grid, **settings))
        response = await self._transport.unary(self._transport.sessions.UpdateSession, session_pb2.UpdateSessionRequest(
            session=wanted, update_mask=field_mask_pb2.FieldMask(paths=paths)))
        return response.session

    async def fit(self) -> session_pb2.Session:
        """Fits the grid to the scene."""
        response = await self._transport.unary(self._transport.sessions.FitSession,
                                               session_pb2.FitSessionRequest(name=self.name))
        return response.session

    async def delete(self) -> None:
        await self._transport.unary(self._transport.sessions.DeleteSession,
                                    session_pb2.DeleteSessionRequest(name=self.name))

    async def export(self) -> bytes:
        """Scene, geometry and settings as a file."""
        parts = self._transport.parts(self._transport.sessions.ExportSession,
                                      session_pb2.ExportSessionRequest(name=self.name))
        return b"".join([part.data async for part in parts])

    async def join(self, display_name: str = "") -> Editor:
        """A member, whose edits are applied once and can be undone."""
        response = await self._transport.unary(self._transport.sessions.JoinSession, session_pb2.JoinSessionRequest(
            session=self.name, display_name=display_name))
        return Editor(self._transport, self.name, response.client)

    async def resume(self, saved: dict[str, Any]) -> Editor:
        """Goes on as the member that Editor.saved told of, in this process or another: what was not answered is sent
        again."""
        import base64

        edits = [scene_pb2.Edit.FromString(base64.b64decode(edit)) for edit in saved["unanswered"]]
        identity = session_pb2.ClientIdentity(client_id=saved["client_id"], secret=saved["secret"])
        return Editor(self._transport, self.name, identity, saved["sequence"], edits)

    async def apply(self, *operations: scene_pb2.Operation) -> scene_pb2.EditAck:
        """An edit by nobody: it cannot be undone, and is not sent again where its answer is lost."""
        response = await self._transport.unary(self._transport.scene.ApplyEdit, scene_pb2.ApplyEditRequest(
            session=self.name, edit=scene_pb2.Edit(operations=operations)))
        return response.ack

    async def lights(self) -> list[scene_pb2.Light]:
        return await _listing(self._transport, self._transport.scene.ListLights,
                              scene_pb2.ListLightsRequest(session=self.name), "lights")

    async def surfaces(self) -> list[scene_pb2.Surface]:
        return await _listing(self._transport, self._transport.scene.ListSurfaces,
                              scene_pb2.ListSurfacesRequest(session=self.name), "surfaces")

    async def cameras(self) -> list[geometry_pb2.Camera]:
        return await _listing(self._transport, self._transport.scene.ListCameras,
                              scene_pb2.ListCamerasRequest(session=self.name), "cameras")

    async def upload(self, content: blob_pb2.Mesh | blob_pb2.Texture) -> str:
        """The hash to name it by: of meshes that do not fit an edit, and of textures."""
        data = content.SerializeToString()
        kind = blob_pb2.BLOB_KIND_MESH if isinstance(content, blob_pb2.Mesh) else blob_pb2.BLOB_KIND_TEXTURE
        parts = [blob_pb2.UploadBlobRequest(data=data[at:at + PART]) for at in range(0, max(len(data), 1), PART)]
        parts[0].header.CopyFrom(blob_pb2.BlobHeader(session=self.name, kind=kind, size=len(data)))
        response = await self._transport.unary(self._transport.blobs.UploadBlob, parts)
        return response.hash

    async def volume(self, format: str = "half", *, stage: str = "transported", compression: str = "unspecified",
                     guard_cells: int = 0, min_revision: int | None = None, timeout: float | None = None) -> Volume:
        """The light in every cell, with every edit that was acknowledged. `format`: half, float or compact."""
        request = _volume_request(self.name, format, stage, compression, guard_cells, min_revision)
        parts, volume = VolumeParts(), None
        async for response in self._transport.parts(self._transport.results.GetVolume, request, timeout):
            volume = parts.add(response.part)
        assert volume is not None, "a volume ends with its last part"
        return volume

    async def frame(self, width: int = 0, height: int = 0, *, camera: geometry_pb2.Camera | str | None = None,
                    format: str = "png", quality: int = 0, samples: int = 0,
                    exposure_ev: float | None = None, min_revision: int | None = None,
                    timeout: float | None = None) -> Frame:
        """A picture, with every edit that was acknowledged. `camera`: scene.camera(...), the name of one of the
        session's, or nothing: a view that the server chooses. `format`: png, jpeg or exr. `samples` of each pixel, for
        edges and textures: 1, 2, 4, 8, 16, 32 or 64; 0 is 16."""
        request = result_pb2.GetFrameRequest(session=self.name, width=width, height=height, quality=quality,
                                             samples=samples, min_revision=min_revision,
                                             exposure=_exposure(exposure_ev))
        request.format = scene.enum(result_pb2.FrameFormat, format)
        if isinstance(camera, str):
            request.camera_name = camera
        elif camera is not None:
            request.camera.CopyFrom(camera)
        parts, frame = FrameParts(), None
        async for response in self._transport.parts(self._transport.results.GetFrame, request, timeout):
            frame = parts.add(response.part)
        assert frame is not None, "a frame ends with its last part"
        return frame

    async def probe(self, points: ArrayLike, normals: ArrayLike = (0.0, 1.0, 0.0), *, min_revision: int | None = None,
                    volume_only: bool = False, around: bool = False) -> Probe:
        """Irradiance at world positions (n, 3) on surfaces with these normals: one each, or one for all. `around`: the
        light all around each position, too, in the order and with the signs of WebXR's light estimates."""
        at = np.asarray(points, "<f8").reshape(-1, 3)
        packed = np.concatenate([at, np.broadcast_to(np.asarray(normals, "<f8"), at.shape)], axis=1)
        got: list[result_pb2.ProbeResponse] = []
        most = _MAX_POINTS_AROUND if around else _MAX_POINTS
        for first in range(0, max(len(packed), 1), most):
            revision = got[-1].result.revision if got else min_revision
            got.append(await self._transport.unary(self._transport.results.Probe, result_pb2.ProbeRequest(
                session=self.name, min_revision=revision, points=packed[first:first + most].tobytes(),
                volume_only=volume_only, around=around)))
        irradiance = np.frombuffer(b"".join(one.irradiance for one in got), "<f8").reshape(-1, 3)
        valid = np.frombuffer(b"".join(one.valid for one in got), np.uint8).astype(bool)
        if not around:
            return Probe(got[-1].result, irradiance, valid)
        main = np.frombuffer(b"".join(one.main_light for one in got), "<f8").reshape(-1, 6)
        return Probe(got[-1].result, irradiance, valid,
                     np.frombuffer(b"".join(one.harmonics for one in got), "<f4").reshape(-1, 9, 3),
                     main[:, :3], main[:, 3:], np.frombuffer(b"".join(one.back_faces for one in got), np.uint8))

    async def pick(self, x: float, y: float, *, subscriber: str = "", camera: geometry_pb2.Camera | None = None,
                   width: int = 0, height: int = 0) -> result_pb2.PickResponse:
        """What a pixel shows: of an open stream of frames, or of a camera and a size."""
        return await self._transport.unary(self._transport.results.Pick, result_pb2.PickRequest(
            session=self.name, subscriber=subscriber, camera=camera, width=width, height=height, x=x, y=y))

    def volumes(self, format: str = "compact", *, stage: str = "transported", compression: str = "unspecified",
                max_rate: float = 0.0, tolerance_class: int = 0, credits: int = 1, guard_cells: int = 0,
                region: tuple[Sequence[float], Sequence[float]] | None = None) -> VolumeStream:
        """Volumes, each of the newest revision when the one before was applied: when the next one is asked for.
        `region`: the minimum and maximum corner of what is wanted, metres."""
        box = None if region is None else geometry_pb2.Box(min=scene.vec3(region[0]), max=scene.vec3(region[1]))
        wanted = volume_pb2.VolumeSubscription(session=self.name, max_rate=max_rate, tolerance_class=tolerance_class,
                                               credits=credits, guard_cells=guard_cells, region=box)
        _fill_formats(wanted, format, stage, compression)
        return VolumeStream(self._transport, wanted)

    def frames(self, width: int = 0, height: int = 0, *, camera: geometry_pb2.Camera | str | None = None,
               format: str = "jpeg", quality: int = 0, samples: int = 0, max_rate: float = 0.0, credits: int = 1,
               adapt_rate: float = 0.0, sharpen: bool = False, exposure_ev: float | None = None) -> FrameStream:
        """Frames, as volumes() has volumes. `adapt_rate`: smaller ones while the line carries fewer a second. `samples`
        as in frame(); 0 is 1. `sharpen`: once everything rests, one more frame comes, made as frame() makes it."""
        wanted = result_pb2.FrameSubscription(session=self.name, width=width, height=height, quality=quality,
                                              samples=samples, max_rate=max_rate, credits=credits,
                                              adapt_rate=adapt_rate, sharpen=sharpen,
                                              exposure=_exposure(exposure_ev))
        wanted.format = scene.enum(result_pb2.FrameFormat, format)
        if isinstance(camera, str):
            wanted.camera_name = camera
        elif camera is not None:
            wanted.camera.CopyFrom(result_pb2.CameraUpdate(camera=camera, sequence=1))
        return FrameStream(self._transport, wanted)

    def changes(self, since_revision: int = 0, editor: Editor | None = None) -> SceneStream:
        """The scene and what becomes of it. With `editor` that member is present while this runs."""
        return SceneStream(self._transport, self.name, since_revision, editor.identity if editor is not None else None)

    async def create_token(self, role: str = "viewer", seconds: int | None = None) -> session_pb2.CreateTokenResponse:
        """An access token: viewer, editor or owner. Default: for 30 days."""
        request = session_pb2.CreateTokenRequest(session=self.name)
        request.role = scene.enum(session_pb2.Role, role)
        if seconds is not None:
            request.ttl.CopyFrom(duration_pb2.Duration(seconds=seconds))
        return await self._transport.unary(self._transport.sessions.CreateToken, request)

    async def tokens(self) -> list[session_pb2.AccessToken]:
        """Id, role and expiry of those that are good; the server does not keep the secrets."""
        return await _listing(self._transport, self._transport.sessions.ListTokens,
                              session_pb2.ListTokensRequest(session=self.name), "tokens")

    async def revoke_token(self, token_id: str) -> None:
        """Ends the token, and every stream that it has opened."""
        await self._transport.unary(self._transport.sessions.RevokeToken,
                                    session_pb2.RevokeTokenRequest(session=self.name, token_id=token_id))


def _fill_formats(out: Any, format: str, stage: str, compression: str) -> None:
    word = "half_float" if format == "half" else format
    out.format = scene.enum(volume_pb2.VolumeFormat, word)
    out.stage = scene.enum(volume_pb2.VolumeStage, stage)
    out.compression = scene.enum(volume_pb2.PayloadCompression, compression)


def _volume_request(session: str, format: str, stage: str, compression: str, guard_cells: int,
                      min_revision: int | None) -> volume_pb2.GetVolumeRequest:
    out = volume_pb2.GetVolumeRequest(session=session, guard_cells=guard_cells, min_revision=min_revision)
    _fill_formats(out, format, stage, compression)
    return out


def _exposure(ev: float | None) -> result_pb2.Exposure | None:
    return None if ev is None else result_pb2.Exposure(ev=ev)


async def _listing(transport: Transport, method: Any, request: Any, field: str) -> list[Any]:
    """All pages."""
    out: list[Any] = []
    while True:
        page = await transport.unary(method, request)
        out.extend(getattr(page, field))
        if not page.next_page_token:
            return out
        request.page_token = page.next_page_token
