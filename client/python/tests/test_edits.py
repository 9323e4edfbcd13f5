"""Edits: in order, once, and answered, whatever becomes of the server meanwhile."""

import json
import math
import threading
import time
import unittest

import numpy as np

import lpv
from lpv import scene
from server import PATIENCE, OnServer, Server, end_a_hang, lamp_at, room


class Edits(OnServer):
    def test_names_revisions_and_one_step_for_a_drag(self):
        editor = self.lit()
        self.assertEqual(editor.apply(*room(False)).names, ["floor.001", "lamp.001"])
        pending = [editor.send(lamp_at(x / 10), undo_group="drag") for x in range(10)]
        editor.drain()
        self.assertEqual([one.result(0).revision for one in pending], list(range(3, 13)))
        self.assertEqual([one.sequence for one in pending], list(range(3, 13)))
        self.assertAlmostEqual(self.lamp().x, 0.9)
        self.assertEqual(editor.undo().revision, 13)
        self.assertAlmostEqual(self.lamp().x, -1.5)
        editor.redo()
        self.assertAlmostEqual(self.lamp().x, 0.9)

    def lamp(self):
        return next(light for light in self.session.lights() if light.name == "lamp").transform.translation

    # Broken by a refusal that ends the stream, and by one that is told to the edit behind it.
    def test_a_refused_edit_says_why_and_the_others_go_on(self):
        editor = self.lit()
        before = editor.send(lamp_at(0.1))
        refused = editor.send(lamp_at(0.2), scene.change_light("lamp", radiance=(1, -1, 1)))
        after = editor.send(lamp_at(0.3))
        editor.drain()
        self.assertEqual((before.result(0).revision, after.result(0).revision), (2, 3))
        self.assertRefused("INVALID_ARGUMENT", refused.result, 0,
                           field="edit.operations[1].update_light.light.radiance")
        self.assertEqual(editor.refused, [refused.future.exception()])
        self.assertRefused("ABORTED", editor.apply, lamp_at(0), expected_revision=2, field="edit.expected_revision",
                           reason="REVISION_CHANGED")
        self.assertRefused("NOT_FOUND", editor.apply, scene.delete_light("nobody"),
                           field="edit.operations[0].delete_light")
        self.assertEqual(editor.reopened, 0)

    def test_another_members_lock(self):
        editor, other = self.lit(), self.join("other")
        other.lock(["lamp"], 60)
        self.assertRefused("ABORTED", editor.apply, lamp_at(0), reason="LOCKED", field="edit.operations[0]")
        other.lock(["lamp"], 0)
        editor.apply(lamp_at(0))

    # Broken by waiting for an answer for ever.
    def test_an_identity_that_the_session_did_not_issue(self):
        saved = {**self.join().saved(), "secret": "0" * 32}
        editor = self.session.resume(saved)
        unknown = dict(field="client", reason="UNKNOWN_CLIENT")
        self.assertRefused("PERMISSION_DENIED", editor.apply, *room(), **unknown)
        self.assertRefused("PERMISSION_DENIED", editor.drain, **unknown)
        self.assertRefused("PERMISSION_DENIED", editor.send, lamp_at(0), **unknown)

    # geometry.proto writes the matrix out: the server reads it as scene.matrix_of has it.
    # Broken by row-major numbers, and by a scale in the world's axes.
    def test_a_matrix_is_what_the_three_fields_make(self):
        editor = self.join()
        turn = np.array([0.2, -0.5, 0.3, math.sqrt(1 - 0.04 - 0.25 - 0.09)])
        placed = dict(translation=(1, 2, 3), rotation=tuple(turn), scale=(0.5, 2, 3))
        matrix = scene.matrix_of(scene.transform(**placed))
        editor.apply(scene.light("fields", scene.quad(1), **placed),
                     scene.light("matrix", scene.quad(1), matrix=matrix))
        fields, read = (light.transform for light in self.session.lights())
        for one in (fields, read):
            np.testing.assert_allclose(scene.matrix_of(one), matrix, atol=1e-12)
        self.assertAlmostEqual(read.scale.y, 2.0)
        np.testing.assert_allclose(matrix[:3, 1], 2 * self.turned(turn, [0, 1, 0]), atol=1e-12)

    @staticmethod
    def turned(quaternion, vector):
        """By q v q*, not by a matrix."""
        axis, w = quaternion[:3], quaternion[3]
        return vector + 2 * np.cross(axis, np.cross(axis, vector) + w * np.asarray(vector))

    def test_vertices_meshes_and_cameras(self):
        editor = self.lit()
        sheet = scene.mesh([[x, 0, z] for z in range(40) for x in range(40)],
                           [[a, a + 40, a + 1] for a in range(39 * 40) if a % 40 != 39])
        name = self.session.upload(sheet)
        editor.apply(scene.surface("sheet", name, albedo=(0.5, 0.25, 0.125), two_sided=False))
        editor.apply(scene.set_vertices("lamp", np.array([[-1, 0, -1], [-1, 0, 1], [1, 0, 1], [1, 0, -1]])))
        editor.apply(scene.put_camera(scene.camera((0, 2, 6), (0, 1, 0), name="front")))
        self.assertEqual({one.name: one.triangle_count for one in self.session.surfaces()}["sheet"], 39 * 39)
        self.assertAlmostEqual(self.session.lights()[0].status.area, 4.0)
        self.assertEqual(self.session.cameras()[0].fov_degrees, 50)


class Interrupted(unittest.TestCase):
    """A server that keeps its state and is killed."""

    def setUp(self):
        end_a_hang(self)
        self.server = Server(state=True)
        self.addCleanup(self.server.close)
        self.client = lpv.connect(self.server.address, timeout=PATIENCE)
        self.addCleanup(self.client.close)
        self.session = self.client.create_session(grid=8)
        self.editor = self.session.join()
        self.editor.apply(*room())

    # Broken by: unanswered edits forgotten with the connection; edits sent again with new sequences.
    def test_every_edit_arrives_once_although_the_server_is_killed_twice(self):
        edits, killed = 600, []

        def kill_and_start():
            acknowledged = 0
            for part in (edits // 4, edits // 2):
                while self.editor.sequence < part or self.editor.revision <= acknowledged:
                    time.sleep(0.001)
                self.server.kill()
                acknowledged = self.editor.revision
                killed.append(self.editor.sequence)
                self.server.start()

        killer = threading.Thread(target=kill_and_start)
        killer.start()
        pending = []
        for step in range(edits):
            pending.append(self.editor.send(lamp_at(step / edits)))
            time.sleep(0.0005)
        killer.join()
        self.editor.drain(PATIENCE)
        self.assertEqual(len(killed), 2)
        self.assertEqual([one.result(0).revision for one in pending], list(range(2, edits + 2)))
        self.assertEqual(self.session.info().revision, edits + 1)
        self.assertAlmostEqual(self.session.lights()[0].transform.translation.x, (edits - 1) / edits)
        self.assertEqual(self.editor.refused, [])
        self.assertGreaterEqual(self.editor.reopened, 2)
        self.editor.close()

    # Broken by sending on for ever, by waiting for ever, and by a loop that does neither.
    def test_the_257th_edit_waits_for_an_answer(self):
        self.server.kill()
        sent = []
        sender = threading.Thread(target=lambda: sent.extend(self.editor.send(lamp_at(0)) for _ in range(300)))
        sender.start()
        while self.editor.sequence < 257:
            time.sleep(0.01)
        sender.join(0.5)
        self.assertEqual((self.editor.sequence, sender.is_alive()), (257, True))
        self.server.start()
        sender.join(PATIENCE)
        self.editor.drain(PATIENCE)
        self.assertEqual((len(sent), self.editor.revision), (300, 301))
        self.editor.close()

    # Broken by: saved() without the edits that were not answered; a sequence that begins again.
    def test_another_process_goes_on_with_what_was_saved(self):
        self.server.kill()
        pending = [self.editor.send(lamp_at(step)) for step in range(5)]
        saved = json.loads(json.dumps(self.editor.saved()))
        self.assertEqual((saved["sequence"], len(saved["unanswered"])), (6, 5))
        with self.assertRaisesRegex(ZeroDivisionError, "by zero"), self.editor:
            1 / 0  # does not wait for answers
        with self.assertRaisesRegex(lpv.Error, "closed before"):
            pending[-1].result(PATIENCE)
        self.assertEqual(self.editor.saved(), saved)
        self.server.start()
        with lpv.connect(self.server.address, timeout=PATIENCE) as other:
            resumed = other.session(saved["session"]).resume(saved)
            resumed.drain(PATIENCE)
            self.assertEqual((resumed.revision, resumed.refused), (6, []))
            again = other.session(saved["session"]).resume(saved)  # all of it once more: the first outcomes again
            again.drain(PATIENCE)
            self.assertEqual((again.revision, self.session.info().revision), (6, 6))
            self.assertEqual(again.apply(lamp_at(0)).sequence, 7)
            again.close()
            resumed.close()


if __name__ == "__main__":
    unittest.main()
