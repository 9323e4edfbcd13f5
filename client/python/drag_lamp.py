#!/usr/bin/env python3
"""Drags a lamp through a room on an lpvd and watches the light follow: the client rules of proto/lpv/v1 in one file.

    mkdir stubs
    protoc -I proto --python_out stubs --grpc_python_out stubs \
           --plugin=protoc-gen-grpc_python=$(command -v grpc_python_plugin) proto/lpv/v1/*.proto
    PYTHONPATH=stubs client/python/drag_lamp.py --server localhost:50051

Debian 12: python3-grpcio, python3-protobuf, protobuf-compiler, protobuf-compiler-grpc.

What an editor's author may want to copy:
  - identity and sequences: every edit has a number; what was not acknowledged is sent again after a broken connection,
    and the server answers a number it has seen before with its first outcome (class Drag);
  - one undo step for the whole drag (Edit.undo_group);
  - one credit: a volume is acknowledged when it has been applied; only then is the next one made (class LightMeter);
  - order: a result below the newest (epoch, revision) seen is thrown away.
"""

import argparse
import array
import collections
import math
import struct
import sys
import threading
import time

import grpc

from lpv.v1 import blob_pb2, geometry_pb2, result_pb2, result_pb2_grpc, scene_pb2, scene_pb2_grpc, session_pb2, \
    session_pb2_grpc

EDITS_PER_SECOND = 60.0
RETRY_SECONDS = 0.2
# A machine that vanishes does not close its connections. Pings detect that; streams would reconnect on a dead one.
KEEPALIVE = [("grpc.keepalive_time_ms", 10000), ("grpc.keepalive_timeout_ms", 5000)]


def vec3(x, y, z):
    return geometry_pb2.Vec3(x=x, y=y, z=z)


def quad(half):
    """A square in the plane y = 0 that faces up."""
    corners = [-half, 0, -half, -half, 0, half, half, 0, half, half, 0, -half]
    return blob_pb2.Mesh(positions=struct.pack("<12f", *corners), indices=struct.pack("<6I", 0, 1, 2, 0, 2, 3))


def room():
    """A floor, and a lamp above it that shines down (half a turn about x)."""
    floor = scene_pb2.Surface(name="floor", inline_mesh=quad(3.0))
    lamp = scene_pb2.Light(name="lamp", inline_mesh=quad(0.25), radiance=vec3(20, 18, 14))
    lamp.transform.translation.CopyFrom(vec3(-1.5, 2, 0))
    lamp.transform.rotation.CopyFrom(geometry_pb2.Quaternion(x=1.0))
    operations = [scene_pb2.Operation(create_surface=floor), scene_pb2.Operation(create_light=lamp)]
    return operations + [scene_pb2.Operation(fit_grid=scene_pb2.FitGrid())]


def lamp_at(x):
    """An operation that changes where the lamp is and nothing else, so that others may recolour it meanwhile."""
    update = scene_pb2.UpdateLight(light=scene_pb2.Light(name="lamp"))
    update.light.transform.translation.CopyFrom(vec3(x, 2, 0))
    update.update_mask.paths.append("transform.translation")
    return scene_pb2.Operation(update_light=update)


class Drag(threading.Thread):
    """Sends edits in order, survives broken connections and servers that restart, ends when all are acknowledged."""

    def __init__(self, channel, session, client, first_sequence):
        super().__init__(daemon=True)
        self.stub = scene_pb2_grpc.SceneServiceStub(channel)
        self.session, self.client = session, client
        self.next_sequence = first_sequence
        self.unacknowledged = collections.OrderedDict()  # sequence -> edit, oldest first
        self.changed = threading.Condition()
        self.finished = False
        self.refused = []
        self.revision = 0
        self.reconnections = -1

    def send(self, operation, group):
        with self.changed:
            edit = scene_pb2.Edit(sequence=self.next_sequence, operations=[operation], undo_group=group)
            self.unacknowledged[edit.sequence] = edit
            self.next_sequence += 1
            self.changed.notify_all()

    def finish(self, timeout):
        with self.changed:
            self.finished = True
            self.changed.notify_all()
        self.join(timeout)
        if self.unacknowledged:
            raise TimeoutError(f"{len(self.unacknowledged)} edits were not acknowledged in {timeout} s")

    def requests(self, alive):
        """Yields all unacknowledged edits from the start, then new ones as they come."""
        yield scene_pb2.StreamEditsRequest(session=self.session, client=self.client)
        sent = 0
        while True:
            with self.changed:
                self.changed.wait_for(lambda: self.next_edit(sent) or self.done() or not alive.is_set(), 1.0)
                edit = self.next_edit(sent)
                if edit is None and (self.done() or not alive.is_set()):
                    return
            if edit is not None:
                sent = edit.sequence
                yield scene_pb2.StreamEditsRequest(edit=edit)

    def next_edit(self, sent):
        return next((e for s, e in self.unacknowledged.items() if s > sent), None)

    def done(self):
        return self.finished and not self.unacknowledged

    def acknowledged(self, ack):
        with self.changed:
            if ack.status.code == grpc.StatusCode.UNAVAILABLE.value[0]:
                return  # outcome unknown: keep it and send it again
            self.unacknowledged.pop(ack.sequence, None)
            self.revision = max(self.revision, ack.revision)
            if ack.status.code:
                self.refused.append(ack.status.message)
            self.changed.notify_all()

    def run(self):
        while not self.done():
            alive = threading.Event()
            alive.set()
            self.reconnections += 1
            try:
                for response in self.stub.StreamEdits(self.requests(alive)):
                    if response.WhichOneof("event") == "ack":
                        self.acknowledged(response.ack)
            except grpc.RpcError as error:
                if error.code() != grpc.StatusCode.UNAVAILABLE:
                    print(f"edits: {error.details()}", file=sys.stderr)
                    return
                time.sleep(RETRY_SECONDS)
            finally:
                alive.clear()


class LightMeter(threading.Thread):
    """Keeps the newest volume: half floats, whole or relative to the last one applied."""

    def __init__(self, channel, session):
        super().__init__(daemon=True)
        self.stub = result_pb2_grpc.ResultServiceStub(channel)
        self.session = session
        self.newest = (0, 0)
        self.bricks = {}
        self.header = None
        self.results = self.bytes = 0
        self.arrived = threading.Condition()
        self.stopped = False

    def run(self):
        while not self.stopped:
            try:
                self.watch()
            except grpc.RpcError as error:
                if error.code() not in (grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.CANCELLED):
                    print(f"volumes: {error.details()}", file=sys.stderr)
                    return
                time.sleep(RETRY_SECONDS)

    def watch(self):
        subscription = result_pb2.VolumeSubscription(
            session=self.session, format=result_pb2.VOLUME_FORMAT_HALF_FLOAT,
            compression=result_pb2.PAYLOAD_COMPRESSION_NONE)
        subscriber, header, received = "", None, {}
        for response in self.stub.WatchVolume(result_pb2.WatchVolumeRequest(subscription=subscription)):
            kind = response.event.WhichOneof("event")
            if kind == "subscribed":
                subscriber = response.event.subscribed.subscriber
            elif kind == "part":
                part = response.event.part
                if part.HasField("header"):
                    header, received = part.header, {}
                received.update(self.bricks_of(header, part))
                if part.index == header.part_count - 1:
                    self.apply(header, received)
                    self.stub.UpdateSubscription(result_pb2.UpdateSubscriptionRequest(
                        session=self.session, subscriber=subscriber, update=result_pb2.SubscriberUpdate(
                            acknowledge=result_pb2.Acknowledge(result_id=header.result.result_id))))

    @staticmethod
    def edge_sizes(header):
        """Of each brick, its cells along x, y, z: those at the upper borders are cut to the grid."""
        def along(cells):
            return [min(header.brick_edge, cells - at) for at in range(0, cells, header.brick_edge)]
        dims = header.grid.dims
        return [(x, y, z) for z in along(dims.z) for y in along(dims.y) for x in along(dims.x)]

    def bricks_of(self, header, part):
        """Brick number -> its bytes: layers, cells, 3 colours x 4 coefficients of 2 bytes."""
        sizes, at, out = self.edge_sizes(header), 0, {}
        self.bytes += len(part.payload)
        for run in part.bricks:
            for number in range(run.first, run.first + run.count):
                length = math.prod(sizes[number]) * len(header.layers) * 12 * 2
                out[number] = part.payload[at:at + length]
                at += length
        assert at == len(part.payload), "a part holds its bricks and nothing else"
        return out

    def apply(self, header, bricks):
        order = (header.result.epoch, header.result.revision)
        with self.arrived:
            self.results += 1
            if order < self.newest:
                return
            self.newest, self.header = order, header
            self.bricks = {**self.bricks, **bricks} if header.base_result_id else bricks
            self.arrived.notify_all()

    def wait_for(self, revision, timeout):
        with self.arrived:
            if not self.arrived.wait_for(lambda: self.newest[1] >= revision, timeout):
                raise TimeoutError(f"no volume of revision {revision} in {timeout} s; the newest is {self.newest[1]}")

    def brightest_x(self):
        """World x of the cells that most light passes through, by fluence (band 0 of green), as a weighted mean."""
        with self.arrived:
            header, bricks = self.header, dict(self.bricks)
        edge, dims, sizes = header.brick_edge, header.grid.dims, self.edge_sizes(header)
        across = -(-dims.x // edge)
        weight = moment = 0.0
        for number, data in bricks.items():
            first_x = number % across * edge
            width, height, depth = sizes[number]
            for layer, info in enumerate(header.layers):
                cells = width * height * depth
                values = struct.unpack_from(f"<{cells * 12}e", data, layer * cells * 24)
                for cell in range(cells):
                    light = (values[cell * 12 + 4] * info.scale) ** 4  # the fourth power: where it is brightest
                    weight += light
                    moment += light * (first_x + cell % width + 0.5)
        return header.grid.origin.x + header.grid.cell_size * moment / weight


def irradiance(channel, session, revision, points):
    """W/m^2 of green at world positions on a floor (normals up), at this revision or a later one."""
    packed = array.array("d")
    for x, y, z in points:
        packed.extend((x, y, z, 0.0, 1.0, 0.0))
    answer = result_pb2_grpc.ResultServiceStub(channel).Probe(
        result_pb2.ProbeRequest(session=session, min_revision=revision, points=packed.tobytes()), wait_for_ready=True)
    assert all(answer.valid), "every point is inside the grid"
    return [rgb[1] for rgb in struct.iter_unpack("<3d", answer.irradiance)]


def main():
    parser = argparse.ArgumentParser(description="Drags a lamp through a room on an lpvd.")
    parser.add_argument("--server", default="localhost:50051", help="HOST:PORT (default: localhost:50051)")
    parser.add_argument("--seconds", type=float, default=2.0, help="duration of the drag (default: 2)")
    parser.add_argument("--patience", type=float, default=30.0,
                        help="seconds to wait for outstanding acknowledgements and volumes (default: 30)")
    arguments = parser.parse_args()

    with grpc.insecure_channel(arguments.server, options=KEEPALIVE) as channel:
        sessions = session_pb2_grpc.SessionServiceStub(channel)
        scenes = scene_pb2_grpc.SceneServiceStub(channel)
        session = sessions.CreateSession(session_pb2.CreateSessionRequest()).session.name
        client = sessions.JoinSession(session_pb2.JoinSessionRequest(session=session)).client
        scenes.ApplyEdit(scene_pb2.ApplyEditRequest(
            session=session, client=client, edit=scene_pb2.Edit(sequence=1, operations=room())))

        meter = LightMeter(channel, session)
        meter.start()
        drag = Drag(channel, session, client, first_sequence=2)
        drag.start()
        steps = max(1, int(arguments.seconds * EDITS_PER_SECOND))
        for step in range(1, steps + 1):
            drag.send(lamp_at(-1.5 + 3.0 * step / steps), group="drag")
            time.sleep(1.0 / EDITS_PER_SECOND)
        drag.finish(arguments.patience)
        meter.wait_for(drag.revision, arguments.patience)

        below = [(-1.5, 0.0, 0.0), (1.5, 0.0, 0.0)]
        left, right = irradiance(channel, session, drag.revision, below)
        print(f"{steps} edits acknowledged, {len(drag.refused)} refused, {drag.reconnections} reconnections, "
              f"revision {drag.revision}")
        print(f"{meter.results} volumes, {meter.bytes / 1024:.0f} KiB; brightest at x = {meter.brightest_x():.2f} m")
        print(f"floor at the drag's start {left:.3f}, at its end {right:.3f} W/m^2")

        undone = scenes.Undo(scene_pb2.UndoRequest(session=session, client=client, sequence=drag.next_sequence))
        left, right = irradiance(channel, session, undone.ack.revision, below)
        print(f"after undo {left:.3f} and {right:.3f} W/m^2")
        meter.stopped = True
        sessions.DeleteSession(session_pb2.DeleteSessionRequest(name=session))
    return 1 if drag.refused else 0


if __name__ == "__main__":
    sys.exit(main())
