"""References of reference_renderer and of Blender's Cycles, kept by what they are made from."""

import hashlib
import json
import pathlib
import shutil
import subprocess
import tempfile
import time

import exr
from product import view_flags

ROOT = pathlib.Path(__file__).resolve().parents[2]
CYCLES = ROOT / "tests/evaluation/cycles/render.py"
RENDERER = ["closed_form", "dump", "estimate", "gloss", "linear_texture", "main", "parallel", "path_tracer", "picture", "sampler", "traced_scene"]


def sources():
    """Files that decide what a reference shows: the renderer's, and those that read the scene."""
    patterns = [f"tests/evaluation/renderer/{name}.*" for name in RENDERER] + ["client/cli/import/*.*"]
    patterns += [f"server/scene/{name}.*" for name in ("camera", "distant_lights", "gloss", "mesh", "scene", "texture", "transform")]
    return sorted(path for pattern in patterns for path in ROOT.glob(pattern))


class Embree:
    """`renderer`: the program reference_renderer. `folder`: the cache."""

    name = "embree"

    def __init__(self, renderer, folder, threads=None):
        self.renderer = pathlib.Path(renderer).resolve()
        if not self.renderer.exists():
            raise FileNotFoundError(f"{self.renderer} is not there; build it: cmake --build BUILD --target reference_renderer")
        self.folder = pathlib.Path(folder)
        self.threads = ["--threads", str(threads)] if threads else []
        digest = hashlib.sha256()
        for path in sources():
            digest.update(path.read_bytes())
        self.version = digest.hexdigest()[:16]

    def default_view(self, scene_file, size):
        """The view that the server would choose."""
        done = self._run(scene_file, "--size", f"{size[0]}x{size[1]}")
        answer = json.loads(done)
        return {key: answer[key] for key in ("eye", "target", "up", "fov")}

    def key(self, scene_file, view, size, samples, filter_name, gloss=False, sky=None):
        """Hash of everything that the reference depends on: the scene's bytes and those of the files beside it that it
        may name, the sky's, the renderer's sources, the camera, size, samples and filter."""
        digest = hashlib.sha256()
        digest.update(json.dumps([self.version, view, size, samples, filter_name] + (["gloss"] if gloss else []), sort_keys=True).encode())
        digest.update(scene_bytes_hash(scene_file))
        if sky:
            digest.update(pathlib.Path(sky).read_bytes())
        return digest.hexdigest()[:24]

    def pictures(self, scene_file, view, size, samples, levels, filter_name="centre", gloss=False, sky=None):
        """({level: layers of exr.read}, key, seconds it took; 0 from the cache). Levels are "0", "2", "all", ..; `sky`: its
        picture."""
        key = self.key(scene_file, view, size, samples, filter_name, gloss, sky)
        stem = self.folder / key
        paths = {level: pathlib.Path(f"{stem}-bounces-{level}.exr") for level in levels}
        seconds = 0.0
        if not all(path.exists() for path in paths.values()):
            self.folder.mkdir(parents=True, exist_ok=True)
            began = time.monotonic()
            part = self.folder / f"{key}.part"
            self._run(scene_file, *view_flags(view, size), "--samples", samples, "--bounces", ",".join(levels),
                      "--filter", filter_name, *(["--gloss"] if gloss else []), *(["--sky", sky] if sky else []), "-o", part)
            for level, path in paths.items():  # whole files only, should this be interrupted
                pathlib.Path(f"{part}-bounces-{level}.exr").rename(path)
            seconds = time.monotonic() - began
        return {level: exr.read(path) for level, path in paths.items()}, key, seconds

    def _run(self, *arguments):
        done = subprocess.run([self.renderer, *map(str, arguments), *self.threads], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"reference_renderer: {done.stderr.strip()}")
        return done.stdout


class Cycles:
    """The same pictures by Blender's Cycles: radiance, position, normal and albedo, filtered by a box of one pixel."""

    name = "cycles"

    def __init__(self, embree, threads=2, split=512):
        self.embree, self.threads, self.split = embree, threads, split
        self.blender = shutil.which("blender")
        self.version = hashlib.sha256(CYCLES.read_bytes()).hexdigest()[:16]

    def missing(self):
        """Why there is none; "" if there is."""
        return "" if self.blender else "blender is not installed"

    def picture(self, scene_file, view, size, samples, level, seed=0, haze=None, gloss=False, sky=None):
        """Layers as exr.read names them: radiance, P, N, A; with haze (cycles/render.py) what it scatters, as "haze", at the
        pixels' middles. `sky`: its picture."""
        key = [self.version, self.split, view, list(size), samples, level, seed, haze, gloss]
        digest = hashlib.sha256(json.dumps(key, sort_keys=True).encode() + scene_bytes_hash(scene_file))
        if sky:
            digest.update(pathlib.Path(sky).read_bytes())
        path = self.embree.folder / f"cycles-{digest.hexdigest()[:24]}.exr"
        if not path.exists():
            self.embree.folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory() as folder:
                self.embree._run(scene_file, "--dump", folder)
                part = path.with_suffix(".part.exr")
                job = {"dump": folder, "view": view, "size": list(size), "samples": samples, "bounces": level,
                       "seed": seed, "threads": self.threads, "output": str(part), "split": self.split,
                       "filter": "centre" if haze else "box", "gloss": gloss,
                       **({"haze": haze} if haze else {}), **({"sky": str(sky)} if sky else {})}
                job_file = pathlib.Path(folder) / "job.json"
                job_file.write_text(json.dumps(job))
                done = subprocess.run([self.blender, "-b", "--factory-startup", "--python-exit-code", "1", "-P", CYCLES,
                                       "--", job_file], capture_output=True, text=True)
                if done.returncode != 0 or not part.exists():
                    raise RuntimeError(f"blender: {done.stdout[-600:]} {done.stderr[-600:]}")
                part.rename(path)
        layers = exr.read(path)
        by_pass = {"Combined": "radiance", "Position": "P", "Normal": "N", "DiffCol": "A", "VolumeDir": "haze"}
        return {by_pass[name.split(".")[-1]]: values for name, values in layers.items()
                if name.split(".")[-1] in by_pass}


def scene_bytes_hash(scene_file):
    """Of the file, and for formats that name others (obj, gltf) of everything in its folder."""
    scene_file = pathlib.Path(scene_file)
    files = [scene_file] if scene_file.suffix in (".glb", ".ply", ".stl") else sorted(
        path for path in scene_file.parent.rglob("*") if path.is_file())
    digest = hashlib.sha256()
    for path in files:
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.digest()
