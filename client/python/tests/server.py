"""A real lpvd on the loopback, for tests. LPVD_PATH is its binary."""

import faulthandler
import os
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import tempfile
import time
import unittest

import lpv
from lpv import scene

LPVD = os.environ.get("LPVD_PATH", "lpvd")
PATIENCE = 60.0  # ends a hang; nothing is measured with it


def lasting_port():
    """A free port outside of the range from which the system gives ports to whoever asks: nobody gets it while its
    server is dead, neither another test's server nor a client that tries to reach the dead one."""
    while True:
        port = random.randrange(12000, 32000)
        with socket.socket() as probe:
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        return port


class Server:
    """Started by the constructor. `state`: keeps sessions, also through kill()."""

    def __init__(self, *arguments, state=False):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="lpv-python-"))
        self.arguments = [LPVD, "--log-level", "warn", "--max-edits-per-second", "100000", *arguments]
        if state:
            self.arguments += ["--state-dir", str(self.folder / "state")]
        self.port, self.process = lasting_port() if state else 0, None
        self.start()

    def start(self):
        told = self.folder / "port"
        told.unlink(missing_ok=True)
        with open(self.folder / "log", "ab") as log:
            listen = ["--listen", f"127.0.0.1:{self.port}", "--port-file", str(told)]
            self.process = subprocess.Popen([*self.arguments, *listen], stdout=log, stderr=log)
        end = time.monotonic() + PATIENCE
        while not (told.exists() and told.read_text().strip()):
            if self.process.poll() is not None or time.monotonic() > end:
                raise RuntimeError(f"lpvd did not come up: {self.log()}")
            time.sleep(0.02)
        self.port = int(told.read_text())

    def log(self):
        return (self.folder / "log").read_text(errors="replace")

    @property
    def address(self):
        return f"127.0.0.1:{self.port}"

    def kill(self):
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def close(self):
        if self.process.poll() is None:
            self.process.terminate()
            self.process.wait()
        shutil.rmtree(self.folder)


def room(fitted=True):
    """A floor, and a lamp 2 m above it that shines down (half a turn about x)."""
    lamp = scene.light("lamp", scene.quad(0.5), radiance=(20, 18, 14), translation=(-1.5, 2, 0), rotation=(1, 0, 0, 0))
    operations = [scene.surface("floor", scene.quad(6)), lamp]
    return [*operations, scene.fit_grid()] if fitted else operations


def lamp_at(x):
    return scene.change_light("lamp", translation=(x, 2, 0))


def end_a_hang(test):
    """A test that waits for what never comes says where, and fails."""
    faulthandler.dump_traceback_later(2 * PATIENCE, exit=True)
    test.addCleanup(faulthandler.cancel_dump_traceback_later)


class OnServer(unittest.TestCase):
    """One server for a class of tests, a session with a lamp for each of them."""

    ARGUMENTS = ()
    STATE = False

    @classmethod
    def setUpClass(cls):
        cls.server = Server(*cls.ARGUMENTS, state=cls.STATE)
        cls.addClassCleanup(cls.server.close)

    def setUp(self):
        end_a_hang(self)
        self.client = lpv.connect(self.server.address, timeout=PATIENCE)
        self.addCleanup(self.client.close)
        self.session = self.client.create_session(grid=20)

    def join(self, name=""):
        editor = self.session.join(name)
        self.addCleanup(editor.abandon)
        return editor

    def lit(self):
        """An editor whose first edit was the room."""
        editor = self.join()
        editor.apply(*room())
        return editor

    def assertRefused(self, code, call, *arguments, field="", reason="", **named):
        with self.assertRaises(lpv.Error) as caught:
            call(*arguments, **named)
        error = caught.exception
        self.assertEqual((error.code.name, error.field, error.reason), (code, field, reason), error.message)
        return error
