"""Volumes and frames as streams: deltas in every format, credit, recovery, and what the wire's comments say."""

import threading
import time
import unittest

import numpy as np
import PIL.Image

import lpv
import lpv.decode
from lpv import scene
from lpv.v1 import result_pb2, scene_pb2, volume_pb2
from server import PATIENCE, OnServer, Server, end_a_hang, lamp_at, room


def furthest(truth, held):
    """The largest difference of a coefficient, relative to its cell's and colour's own L00."""
    near = np.maximum(truth[..., :1], 1e-5 * truth[..., 0].max())
    return float((np.abs(truth - held) / near).max())


class Volumes(OnServer):
    # How far a cell may be from the truth: not at all; by half's precision; by COMPACT.md 4, once for each of two.
    FORMATS = {"float": 0.0, "half": 2.0**-10, "compact": 0.02}

    # Broken by: a delta added to the newest result instead of its base; planes predicted along another axis.
    def test_deltas_add_up_to_what_get_volume_has(self):
        editor = self.lit()
        for form, tolerance in self.FORMATS.items():
            for compression in ("none", "zstd"):
                with self.subTest(format=form, compression=compression), \
                        self.session.volumes(form, compression=compression) as volumes:
                    deltas = 0
                    for step, volume in enumerate(volumes):
                        deltas += volume.header.base_result_id != 0
                        whole = self.session.volume(form, compression=compression)
                        truth = self.session.volume("float")
                        self.assertEqual((volume.revision, whole.revision, truth.revision), (editor.revision,) * 3)
                        self.assertEqual(whole.header.base_result_id, 0)
                        self.assertLessEqual(furthest(truth.coefficients, volume.coefficients), tolerance)
                        self.assertLessEqual(furthest(whole.coefficients, volume.coefficients), tolerance)
                        if step == 6:
                            break
                        editor.apply(lamp_at(-1.5 + 0.3 * step))
                    self.assertEqual((volumes.watch.faults, volumes.watch.results), (0, 7))
                    self.assertEqual(deltas, 6)
                    self.assertGreater(volume.coefficients.max(), 0)

    # Broken by: the stream ends, or goes on with what it has.
    def test_a_base_that_was_lost_costs_a_key_frame(self):
        editor = self.lit()
        with self.session.volumes("half") as volumes:
            first = next(volumes)
            volumes.watch._parts._held.clear()
            editor.apply(lamp_at(1))
            second = next(volumes)
            self.assertEqual(volumes.watch.faults, 1)
            self.assertEqual((first.header.base_result_id, second.header.base_result_id), (0, 0))
            editor.apply(lamp_at(0))
            self.assertEqual(next(volumes).header.base_result_id, second.result_id)
            volumes.request_key_frame()
            editor.apply(lamp_at(1))
            self.assertEqual(next(volumes).header.base_result_id, 0)

    # Broken by asking for one key frame after the other.
    def test_a_key_frame_that_cannot_be_read_is_told(self):
        self.lit()
        volumes = self.session.volumes("half")
        next(volumes)
        volumes.request_key_frame()
        shape = lpv.decode.Shape.of
        self.addCleanup(setattr, lpv.decode.Shape, "of", staticmethod(shape))

        def unknown(header):
            header.coefficients = 9
            return shape(header)

        lpv.decode.Shape.of = staticmethod(unknown)
        with self.assertRaisesRegex(lpv.Malformed, "9 coefficients"):
            next(volumes)
        self.assertEqual(list(volumes), [])

    def test_a_region_has_its_bricks_and_no_others(self):
        self.lit()
        x, y, z = self.session.volume().centres()
        with self.session.volumes("float", region=((x[0], y[0], z[0]), (x[1], y[1], z[1]))) as volumes:
            part = next(volumes).coefficients
        truth = self.session.volume("float").coefficients
        np.testing.assert_array_equal(part[:, :8, :8, :8], truth[:, :8, :8, :8])
        self.assertFalse(part[:, 8:].any() or part[..., 8:, :, :].any())

    def test_layers_are_the_groups_of_lights(self):
        editor = self.lit()
        editor.apply(scene.light("red", scene.quad(0.5), radiance=(9, 0, 0), group="stage", translation=(1, 1, 0)))
        volume = self.session.volume("float")
        self.assertEqual(volume.groups, ("", "stage"))
        self.assertEqual(volume.coefficients.shape[0], 2)
        self.assertFalse(volume.coefficients[1, ..., 1:, :].any())  # no green, no blue
        self.assertTrue(volume.coefficients[1, ..., 0, :].any())
        injected = self.session.volume("float", stage="injected")
        self.assertEqual(injected.header.stage, volume_pb2.VOLUME_STAGE_INJECTED)

    # A credit is given back when the next volume is asked for. Broken by acknowledging what has just arrived.
    def test_a_reader_that_does_not_ask_is_sent_nothing(self):
        editor = self.lit()
        with self.session.volumes() as volumes:
            next(volumes)
            for step in range(5):
                editor.apply(lamp_at(step / 5))
                self.session.volume()  # a tick of its own for each
            self.assertEqual(next(volumes).revision, editor.revision)
            self.assertEqual(volumes.watch.results, 2)

    # Broken by a stream that stays open behind a loop that was left.
    def test_a_loop_that_is_left_ends_its_stream(self):
        self.lit()
        for _ in self.session.volumes():
            self.assertEqual(self.session.info().subscriber_count, 1)
            break
        end = time.monotonic() + PATIENCE
        while self.session.info().subscriber_count:
            self.assertLess(time.monotonic(), end)
            time.sleep(0.02)

    def test_closing_wakes_who_waits(self):
        self.lit()
        volumes = self.session.volumes()
        next(volumes)
        threading.Timer(0.2, volumes.close).start()
        self.assertEqual(list(volumes), [])

    # What result.proto says of a client that closes its side.
    def test_half_closing_ends_a_stream_and_says_so(self):
        self.lit()
        results = self.client._calls._transport.results
        wanted = volume_pb2.VolumeSubscription(session=self.session.name)
        call = results.StreamVolume(iter([result_pb2.StreamVolumeRequest(subscription=wanted)]), timeout=PATIENCE)
        events = [answer.event for answer in call]
        self.assertEqual(events[-1].notice.kind, scene_pb2.Notice.KIND_CLIENT_CLOSED)
        self.assertEqual(call.code().name, "OK")


class Survival(unittest.TestCase):
    # Broken by results of the epoch before that are still taken, and by a stream that is not opened again.
    def test_streams_go_on_behind_a_server_that_was_killed(self):
        end_a_hang(self)
        server = Server(state=True)
        self.addCleanup(server.close)
        with lpv.connect(server.address, timeout=PATIENCE) as client:
            session = client.create_session(grid=8)
            editor = session.join()
            editor.apply(*room())
            with session.volumes() as volumes, session.changes(editor=editor) as changes:
                before = next(volumes)
                self.assertEqual(next(changes).snapshot.revision, 1)
                server.kill()
                server.start()
                editor.apply(lamp_at(1))
                after = next(volume for volume in volumes if volume.revision == 2)
                self.assertGreater(after.header.result.epoch, before.header.result.epoch)
                self.assertGreaterEqual(volumes.watch.reopened, 1)
                seen = next(one for one in changes
                            if 2 in (one.snapshot.revision, one.change.last_revision))
                lights = list(seen.snapshot.lights) + list(seen.change.lights)
                self.assertAlmostEqual(lights[0].transform.translation.x, 1)
            editor.close()


class Frames(OnServer):
    def test_pictures_are_arrays_and_files(self):
        self.lit()
        camera = scene.camera((0, 3, 6), (0, 0, 0))
        png = self.session.frame(160, 90, camera=camera, exposure_ev=0)
        self.assertEqual((png.array.shape, png.array.dtype), ((90, 160, 3), np.uint8))
        self.assertEqual(png._repr_png_(), png.file)
        self.assertEqual(png.file[:8], b"\x89PNG\r\n\x1a\n")
        jpeg = self.session.frame(160, 90, camera=camera, format="jpeg", quality=95, exposure_ev=0)
        self.assertLess(np.abs(jpeg.array.astype(int) - png.array).mean(), 3.0)
        self.assertEqual(jpeg._repr_png_()[:4], b"\x89PNG")
        exr = self.session.frame(160, 90, camera=camera, format="exr")
        self.assertEqual(exr.file[:4], b"v/1\x01")
        self.assertRaises(ValueError, lambda: exr.array)
        one, eight = (self.session.frame(160, 90, camera=camera, samples=n, exposure_ev=0).array for n in (1, 8))
        self.assertGreater(np.abs(one.astype(int) - eight).max(), 10, "edges")
        self.assertRefused("INVALID_ARGUMENT", self.session.frame, camera=camera, samples=3, field="samples")
        self.assertIsNone(exr._repr_png_())

    # Broken by a camera that is lost with the stream, and by updates with the same sequence.
    def test_a_camera_moves_and_frames_say_which_they_show(self):
        self.lit()
        with self.session.frames(64, 48, camera=scene.camera((0, 3, 6), (0, 0, 0)), exposure_ev=0) as frames:
            first = next(frames)
            self.assertEqual(first.header.camera_sequence, 1)
            sequence = frames.set_camera(scene.camera((0, 6, 0.1), (0, 0, 0)))
            self.assertEqual(sequence, 2)
            second = next(frame for frame in frames if frame.header.camera_sequence == sequence)
            self.assertGreater(np.abs(second.array.astype(int) - first.array).max(), 20)
            frames.set_size(80, 60)
            third = next(frame for frame in frames if frame.array.shape == (60, 80, 3))
            self.assertEqual(third.header.camera_sequence, sequence)
            self.assertEqual(self.session.pick(20, 30, subscriber=frames.watch.subscriber).object, "floor")


class Notebook(OnServer):
    # Broken by a picture that is upside down, or of another axis.
    def test_a_volume_shows_itself(self):
        import io

        editor = self.lit()
        editor.apply(lamp_at(1.5))
        volume = self.session.volume()
        picture = PIL.Image.open(io.BytesIO(volume._repr_png_()))
        self.assertEqual((picture.format, picture.height), ("PNG", 240))
        z, y, x, _ = volume.fluence().shape
        seen_along_z = np.asarray(picture)[:, :240 * x // y].sum(axis=2)
        rows, columns = np.nonzero(seen_along_z > 0.98 * seen_along_z.max())
        self.assertGreater(columns.mean() / seen_along_z.shape[1], 0.6)  # the lamp is on the right
        self.assertLess(rows.mean() / seen_along_z.shape[0], 0.5)  # and above
        self.assertIn("revision", repr(volume))

    # The fluence of a volume against what is asked of the server at the same places.
    def test_fluence_and_probes_agree_about_where_it_is_bright(self):
        self.lit()
        volume = self.session.volume("float")
        x, y, z = volume.centres()
        light = volume.fluence()[..., 1]
        floor = light[:, np.abs(y).argmin()]
        at_z, at_x = np.unravel_index(floor.argmax(), floor.shape)
        self.assertLess(abs(x[at_x] + 1.5), 0.5)
        self.assertLess(abs(z[at_z]), 0.5)
        probe = self.session.probe([(-1.5, 0, 0), (1.5, 0, 0)])
        self.assertTrue(probe.valid.all())
        self.assertGreater(probe.irradiance[0, 1], 5 * probe.irradiance[1, 1] * 0.5)
        self.assertIsNone(probe.harmonics)

    # Broken by colours and coefficients exchanged, and by batches of 16384.
    def test_the_light_around_points(self):
        self.lit()
        points = [(-1.5, 0.2, 0)] * 300
        probe = self.session.probe(points, around=True)
        self.assertEqual(probe.harmonics.shape, (300, 9, 3))
        direction, light = probe.main_direction[299], probe.main_irradiance[299]
        self.assertGreater(direction[1], 0.9)  # the lamp hangs above
        np.testing.assert_allclose(np.linalg.norm(direction), 1.0)
        band1 = probe.harmonics[299, (3, 1, 2), 1]
        self.assertGreater(band1 @ direction, 0.99 * np.linalg.norm(band1))
        self.assertGreater(light.min(), 0.0)
        self.assertEqual(probe.back_faces[0], 0)
        self.assertTrue(probe.valid.all())


if __name__ == "__main__":
    unittest.main()
