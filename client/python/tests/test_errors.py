"""Refusals carry code, field and reason; access tokens; sessions as files."""

import concurrent.futures
import subprocess
import tempfile
import threading
import unittest

import grpc
import lpv
from lpv import scene
from lpv.v1 import session_pb2
from server import PATIENCE, OnServer, Server, lasting_port, room

ADMIN = "the admin's token, for a test"


class Connections(unittest.TestCase):
    def test_a_server_that_is_about_to_listen_is_reached(self):
        """The first attempt is refused; what answers then has none of lpvd's calls."""
        address = f"127.0.0.1:{lasting_port()}"
        server = grpc.server(concurrent.futures.ThreadPoolExecutor())
        with lpv.connect(address) as client:
            threading.Timer(0.05, lambda: server.add_insecure_port(address) and server.start()).start()
            with self.assertRaises(lpv.Error) as refused:
                client.info()
        server.stop(None)
        self.assertEqual(refused.exception.code, grpc.StatusCode.UNIMPLEMENTED)


class Refusals(OnServer):
    ARGUMENTS = ("--max-lights", "2")

    def test_a_limit_is_named(self):
        editor = self.lit()
        lamps = [scene.light(f"l{i}", scene.quad(1)) for i in range(2)]
        refusal = self.assertRefused("RESOURCE_EXHAUSTED", editor.apply, *lamps, reason="MAX_LIGHTS",
                                     field="edit.max_lights")
        self.assertEqual(refusal.metadata["limit"], "max_lights")
        self.assertIn("2", refusal.message)

    def test_calls_name_the_field(self):
        self.lit()
        self.assertRefused("INVALID_ARGUMENT", self.session.frame, 8, 8, field="width")
        self.assertRefused("NOT_FOUND", self.session.frame, camera="nobody", field="camera_name")
        self.assertRefused("NOT_FOUND", self.client.session("nobody").info, field="session")
        self.assertRefused("NOT_FOUND", next, self.client.session("nobody").volumes(), field="subscription.session")
        self.assertRefused("FAILED_PRECONDITION", self.session.tokens)
        self.assertRefused("ALREADY_EXISTS", self.client.create_session, self.session.name.split("/")[1],
                           field="session_id", reason="NAME_TAKEN")
        self.assertRefused("DEADLINE_EXCEEDED", self.session.volume, min_revision=1000, timeout=0.3)

    def test_words_that_are_none(self):
        with self.assertRaisesRegex(ValueError, "accurate"):
            self.client.create_session(quality="best")
        with self.assertRaisesRegex(ValueError, "quality"):
            self.client.create_session(qualities="fast")
        with self.assertRaisesRegex(ValueError, "radiation"):
            scene.light("lamp", scene.quad(1), radiation=(1, 1, 1))

    def test_no_server(self):
        with lpv.connect("127.0.0.1:1", timeout=5) as nobody:
            self.assertRaisesRegex(lpv.Error, "connect", nobody.info)

    def test_settings_and_files(self):
        self.lit()
        session = self.session.update(bounces=0, transport="gather", grid=12)
        self.assertEqual((session.settings.bounces, session.settings.grid.longest), (0, 12))
        self.assertEqual(self.client.info().limits.max_lights, 2)
        copy = self.client.import_session(self.session.export())
        self.assertEqual([light.name for light in copy.lights()], ["lamp"])
        self.assertIn(copy.name, [one.name for one in self.client.sessions()])
        copy.delete()
        self.assertNotIn(copy.name, [one.name for one in self.client.sessions()])


class Tokens(unittest.TestCase):
    def setUp(self):
        file = tempfile.NamedTemporaryFile("w", suffix=".token")
        self.addCleanup(file.close)
        file.write(ADMIN + "\n")
        file.flush()
        self.server = Server("--admin-token-file", file.name)
        self.addCleanup(self.server.close)
        with lpv.connect(self.server.address, token_file=file.name, timeout=PATIENCE) as admin:
            made = admin.create_session()
        self.name, self.owner_token = made.name, made.owner_token

    def session_of(self, token):
        client = lpv.connect(self.server.address, token=token, timeout=PATIENCE)
        self.addCleanup(client.close)
        return client.session(self.name)

    def refusal(self, call, *arguments):
        with self.assertRaises(lpv.Error) as caught:
            call(*arguments)
        return caught.exception.code.name

    # Broken by a token that is left out of a stream's metadata.
    def test_roles_list_and_revocation(self):
        owner = self.session_of(self.owner_token)
        made = owner.create_token("viewer", seconds=600)
        viewer = self.session_of(made.token)
        listed = {token.token_id: token for token in owner.tokens()}
        self.assertEqual({token.role for token in listed.values()}, {session_pb2.ROLE_OWNER, session_pb2.ROLE_VIEWER})
        self.assertEqual(listed[made.token_id].expire_time, made.expire_time)
        self.assertEqual(self.refusal(viewer.tokens), "PERMISSION_DENIED")
        owner.apply(*room())
        self.assertEqual(self.refusal(viewer.apply, *room()), "PERMISSION_DENIED")
        volumes = viewer.volumes()
        self.assertEqual(next(volumes).revision, 1)
        owner.revoke_token(made.token_id)
        self.assertEqual(self.refusal(next, volumes), "UNAUTHENTICATED")
        self.assertEqual(self.refusal(viewer.info), "UNAUTHENTICATED")
        self.assertEqual(self.refusal(self.session_of("").info), "UNAUTHENTICATED")
        self.assertEqual(len(owner.tokens()), 1)


class Tls(unittest.TestCase):
    # Broken by a connection in plain text, and by certificates of anybody.
    def test_a_server_is_believed_by_its_authority(self):
        with tempfile.TemporaryDirectory() as folder:
            key, certificate = f"{folder}/key", f"{folder}/certificate"
            subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1",
                            "-nodes", "-keyout", key, "-out", certificate, "-days", "1", "-subj", "/CN=localhost",
                            "-addext", "subjectAltName=IP:127.0.0.1"], check=True, capture_output=True)
            server = Server("--tls-cert", certificate, "--tls-key", key)
            self.addCleanup(server.close)
            with lpv.connect(server.address, ca=certificate, timeout=PATIENCE) as client:
                session = client.create_session(grid=8)
                session.apply(*room())
                self.assertEqual(next(session.volumes()).revision, 1)
            for stranger in (lpv.connect(server.address, tls=True, timeout=5), lpv.connect(server.address, timeout=5)):
                with stranger, self.assertRaises(lpv.Error) as caught:
                    stranger.info()
                self.assertEqual(caught.exception.code.name, "UNAVAILABLE")
            with self.assertRaisesRegex(ValueError, "give both or none"):
                lpv.connect(server.address, certificate=certificate)


if __name__ == "__main__":
    unittest.main()
