"""A server of a build folder, driven through lpvctl as a user would."""

import json
import os
import pathlib
import re
import subprocess
import tempfile
import time

import numpy as np

import exr


class Failed(RuntimeError):
    """A command of the product that ended with an error, in its words."""


def view_flags(view, size):
    """Flags of a camera, for lpvctl and reference_renderer alike."""
    flags = [f"--eye={number_list(view['eye'])}", f"--target={number_list(view['target'])}", f"--fov={view['fov']:.17g}"]
    if "up" in view:
        flags.append(f"--up-vector={number_list(view['up'])}")
    return flags + ["--size", f"{size[0]}x{size[1]}"]


def number_list(numbers):
    return ",".join(f"{x:.17g}" for x in numbers)


def settings_of(shown):
    """What decides the light, flat."""
    out = {key: value for key, value in shown["settings"].items()
           if not isinstance(value, (dict, list)) and key not in ("displayName", "ttl")}
    grid = shown["grid"]
    out["grid_dims"] = "x".join(str(grid["dims"][axis]) for axis in "xyz")
    out["cell_size"] = grid["cellSize"]
    out["expected_error"] = shown.get("expectedError")
    return out


class Server:
    """lpvd on a free port, and its command line client. Use as a context."""

    def __init__(self, build, device="software", timeout=600):
        self.build = pathlib.Path(build).resolve()
        self.timeout = timeout
        self.scratch = tempfile.TemporaryDirectory()
        port = pathlib.Path(self.scratch.name) / "port"
        self.log = open(pathlib.Path(self.scratch.name) / "lpvd.log", "wb")
        self.process = subprocess.Popen(
            [self.build / "bin/lpvd", "--listen", "127.0.0.1:0", "--port-file", port, "--device", device,
             "--self-check", "0", "--max-tick-seconds", "80000"], stdout=self.log, stderr=self.log)
        for _ in range(600):
            if port.exists() and port.read_text().strip() or self.process.poll() is not None:
                break
            time.sleep(0.05)
        if not port.exists():
            raise Failed("lpvd did not come up: " + pathlib.Path(self.log.name).read_text()[-400:])
        self.environment = dict(os.environ, LPV_SERVER="127.0.0.1:" + port.read_text().strip())

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait()
        self.log.close()
        self.scratch.cleanup()

    def run(self, *arguments, stdin=None):
        command = [self.build / "bin/lpvctl", "--timeout", str(self.timeout), *map(str, arguments)]
        done = subprocess.run(command, env=self.environment, input=stdin, capture_output=True, text=True)
        if done.returncode != 0:
            raise Failed(f"lpvctl {' '.join(map(str, arguments))}: {done.stderr.strip()}{self.end()}")
        return done.stdout

    def end(self):
        """What is known of the server's end, "" while it runs."""
        if self.process.poll() is None:
            return ""
        return f"; lpvd ended with {self.process.returncode}: {pathlib.Path(self.log.name).read_text(errors='replace')[-400:].strip()}"

    def device(self):
        """What the server's log says of driver and device, "" where it does not."""
        found = re.search(r"info (OpenGL .*)", pathlib.Path(self.log.name).read_text(errors="replace"))
        return found.group(1) if found else ""

    def load(self, file, flags, sky=None):
        """The name of a new session with the scene in it, lit by a picture of the sky if there is one."""
        session = json.loads(self.run("--json", "session", "create", *flags))["session"]["name"]
        self.run("scene", "load", session, file)
        if sky:
            self.run("light", "sky", session, sky)
        return session

    def show(self, session):
        return json.loads(self.run("--json", "session", "show", session))

    def frame(self, session, view, size, samples=1):
        """(linear radiance (height, width, 3), the answer's header, seconds that the call took). `samples`: of each pixel,
        for edges and textures; 0: as the server has it."""
        path = pathlib.Path(self.scratch.name) / "frame.exr"
        began = time.monotonic()
        header = json.loads(self.run("--json", "frame", "get", session, "-o", path, "--samples", samples,
                                     *view_flags(view, size)))
        return exr.read(path)["radiance"], header["header"], time.monotonic() - began

    def volume(self, session):
        """(coefficients (nz, ny, nx, 3, 4) with one cell more on each side, {"origin", "cell"} in metres)."""
        path = pathlib.Path(self.scratch.name) / "volume.npy"
        self.run("volume", "get", session, "--guard", "-o", path)
        grid = self.show(session)["grid"]
        return np.load(path), {"origin": np.array([grid["origin"][axis] for axis in "xyz"]), "cell": grid["cellSize"]}

    def probe(self, session, positions, normals):
        """Irradiance (points, 3), nan outside the grid."""
        lines = [number_list([*p, *n]) for p, n in zip(positions, normals)]
        answer = self.run("probe", session, "--points", "-", stdin="\n".join(lines) + "\n")
        return np.array([[float(x) for x in line.split(",")[6:9]] for line in answer.split()]).reshape(-1, 3)

    def delete(self, session):
        self.run("session", "delete", session)
