"""The parts of the full report: which program measures what, how much of it, and the rows that come of it."""

import collections
import importlib.util
import json
import os
import pathlib
import subprocess

import results

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = pathlib.Path(__file__).resolve().parent
LUCY, ROOM = "meshes/stanford_lucy_33446.ply", "scenes/living_room.glb"
# Default flags, and each of these in the place of one default.
FRAME_FLAGS = ("", "--grid 16", "--grid 64", "--quality accurate", "--bounces 1", "--bounces 0", "--visibility off --bounces 0",
               "--transport direct", "--lookup sh2 --bounces 0", "--transport propagate --bounces 0 --visibility off")
FRAME_SCENES = "two_boxes,television,cornell_box"

Part = collections.namedtuple("Part", "name what measure")


class Failed(RuntimeError):
    """A part that could not be measured, in a sentence."""


class LeftOut(Failed):
    """A part that this size of the report does without."""


class Run:
    """How much is measured, with what, and where it goes."""

    def __init__(self, build, data, output, size, seconds):
        self.build, self.data, self.output, self.size, self.seconds = build, data, output, size, seconds
        self.device = {"choice": "auto", "driver": ""}
        self.environment = dict(os.environ)
        if self.has(LUCY):
            self.environment["LPV_BENCH_LUCY"] = str(data / LUCY)

    def has(self, file):
        return self.data is not None and (self.data / file).is_file()

    def by_size(self, smoke, usual, most=None):
        return {"smoke": smoke, "usual": usual, "all": usual if most is None else most}[self.size].split()

    def program(self, name):
        path = self.build / "bin" / name
        if not path.is_file():
            raise (LeftOut if self.size == "smoke" else Failed)(f"{path} is missing; cmake --build {self.build} --target {name}")
        return path

    def start(self, command, folder):
        log = folder / "log.txt"
        with open(log, "a") as file:
            done = subprocess.run([str(word) for word in command], env=self.environment, stdout=file, stderr=file,
                                  stdin=subprocess.DEVNULL)
        if done.returncode:
            said = log.read_text(errors="replace").strip().splitlines()
            raise Failed(f"{pathlib.Path(command[0]).name} ended with {done.returncode}: {said[-1] if said else 'it said nothing'}")

    def bench(self, folder, name, *arguments):
        """The rows of one bench's run."""
        file = folder / f"{name}.rows"
        file.unlink(missing_ok=True)
        self.start([self.program(name), *arguments, "--rows", file], folder)
        rows, driver = read_rows(file)
        self.device = {"choice": "auto", "driver": driver}
        return rows

    def script(self, folder, name, *arguments):
        """What a script of this house writes itself: its document."""
        self.start([HERE.parent / name, "--build", self.build, "--output", folder, *arguments], folder)
        document = json.loads((folder / "results.json").read_text())
        self.device = document["device"]
        return document


def read_rows(path):
    """(rows, driver) of a file that tests/bench/rows.h wrote."""
    rows, driver = [], ""
    for line in path.read_text().splitlines():
        found = json.loads(line)
        if "driver" in found:
            driver = found["driver"]
        else:
            rows.append(found)
    return rows, driver


def stages(run, folder):
    out = folder / "stages.json"
    run.start([run.program("core_bench"), f"--benchmark_out={out}", "--benchmark_out_format=json", "--benchmark_repetitions=3",
               *run.by_size("--benchmark_filter=32", "--benchmark_filter=.")], folder)
    return rows_of_stages(out)


def rows_of_stages(path):
    """Medians of a Google Benchmark file, a row each."""
    rows = []
    for one in json.loads(path.read_text())["benchmarks"]:
        if one.get("aggregate_name") != "median":
            continue
        times = {f"{stage}_ms": value for stage, value in stage_times(one).items()}
        rates = {key: value for key, value in counters(one).items() if is_rate(key)}
        rows.append({"case": one["run_name"].removesuffix("/real_time"), "quantity": "stages", "settings": {},
                     "values": {"whole_ms": one["real_time"], **times, **rates}})
    return rows


def counters(one):
    return {key: value for key, value in one.items() if isinstance(value, float) and key not in ("real_time", "cpu_time")}


def is_rate(name):
    return "_per_s" in name or "_share_" in name


LEAST = "_least"


def stage_times(one):
    """{stage: ms} of one entry of a Google Benchmark file of core_bench: medians of its ticks."""
    return {key: value for key, value in counters(one).items() if not is_rate(key) and not key.endswith(LEAST)}


def least_times(one):
    """The same: what the quickest tick took, which what else the machine does moves least."""
    return {key.removesuffix(LEAST): value for key, value in counters(one).items() if key.endswith(LEAST)}


def paper(run, folder):
    return run.bench(folder, "injection_bench",
                     *run.by_size("--repeats 1 --grids 32 --mesh sphere", "--repeats 9 --grids 32,64", "--repeats 9 --grids 32,64,128"))


def paper_pictures(run, folder):
    import paper_pictures as drawn  # needs numpy and matplotlib, the rest does not
    rows = run.bench(folder, "paper_bench", "--pictures", folder / "floats",
                     *run.by_size("--grid 16 --light pyramid", "--grid 64"))
    return drawn.with_pictures(rows, folder)


READERS = 10000


def served(rows):
    """With what a tick and its readers take together: DIRECT makes nothing in its tick, and all of it for every receiver."""
    for row in rows:
        values = row["values"]
        if values.get("tick_seconds") is not None and values.get("receiver_us") is not None:
            values["served_seconds"] = values["tick_seconds"] + 1e-6 * READERS * values["receiver_us"]
    return rows


def transports(run, folder):
    return served(run.bench(folder, "accuracy_bench", *run.by_size("--grids 16 --mesh quad --poses 1 --repeats 1", "--poses 2",
                                                                   "--poses 2 --grids 16,24,32,48,64")))


def lookups(run, folder):
    return run.bench(folder, "lookup_bench", *run.by_size("--mesh quad --poses 1", ""))


def frames(run, folder):
    """Default flags, and each other in place of one default; the report joins them to fronts."""
    run.program("reference_renderer")
    rows, skipped = [], []
    scenes = [name for name in FRAME_SCENES.split(",") if name != "cornell_box" or run.has("cornell_box/CornellBox-Original.obj")]
    for i, flags in enumerate(FRAME_FLAGS[:1] if run.size == "smoke" else FRAME_FLAGS):
        part = folder / f"flags{i}"
        part.mkdir(parents=True, exist_ok=True)
        data = ["--data", run.data] if run.data else []
        document = run.script(part, "evaluation/evaluate", *data, "--scenes", ",".join(scenes), "--size", "160x90", "--samples",
                              *run.by_size("16", "512", "1536"), "--points", *run.by_size("50", "400", "1000"), f"--flags={flags}")
        rows += [moved(row, f"flags{i}") for row in document["rows"]]
        skipped += document["skipped"]
    return rows, skipped


def moved(row, folder):
    """The row with its pictures' paths from the folder above."""
    row = dict(row)
    if row.get("picture"):
        row["picture"] = f"{folder}/{row['picture']}"
    if row.get("images"):
        row["images"] = {name: f"{folder}/{path}" for name, path in row["images"].items()}
    return row


def edges(run, folder):
    run.program("reference_renderer")
    scenes = "two_boxes" if run.size == "smoke" else "two_boxes,knot,chair"
    document = run.script(folder, "evaluation/evaluate", "--edges", "--scenes", scenes, "--size", "160x90")
    return document["rows"], document["skipped"]


def coding(run, folder):
    return run.bench(folder, "codec_bench", "--results", *run.by_size("3", "40"))


def steadiness(run, folder):
    return (run.bench(folder, "creep_bench", *run.by_size("--steps 4 --grid 16", "--steps 40", "--steps 100"))
            + run.bench(folder, "change_bench", *run.by_size("--steps 3 --grids 16", "--steps 40")))


def features(run, folder):
    return run.bench(folder, "feature_bench", *run.by_size("--ticks 1 --grid 8", "--ticks 9"))


def scale(run, folder):
    rows = run.bench(folder, "scale_bench", *run.by_size("--ticks 1 --most 16", "--ticks 5 --most 100000", "--ticks 7"))
    readers = run.bench(folder, "stream_bench", "--readers-only", *run.by_size("--readers 1,2 --results 10", "--readers 1,4,16,64"))
    return rows + [{"case": "readers of a volume", "quantity": "scale", "settings": {"count": row["settings"]["readers"]},
                    "values": {"processor_ms": row["values"]["processor_ms"]}} for row in readers]


# A television's picture, one side, its foot at the origin.
SCREEN = "v -.5 .6 0\nv .5 .6 0\nv .5 1.2 0\nv -.5 1.2 0\nf 1 2 3\nf 1 3 4\n"


ROOM_CAMERA = {"eye": (2.0, 1.5, 7.5), "target": (0.0, 1.0, 2.0), "fov": 60}


def service(run, folder):
    plain = ("--visibility", "off", "--bounces", "0")
    asked = [("room, moving sphere", plain), ("room, moving sphere, all bounces", ()),
             ("room, moving sphere, volume watched too", (*plain, "--volume")),
             ("room, sphere deforming at 10 Hz", (*plain, "--light-triangles", "33000", "--deform", "--rate", "10"))]
    compared = {"room, moving sphere, all bounces": (None, None)}
    if run.has(ROOM) and run.has(LUCY) and run.size != "smoke":
        screen = folder / "screen.obj"
        screen.write_text(SCREEN)
        view = ("--scene", run.data / ROOM, "--camera", *ROOM_CAMERA["eye"], *ROOM_CAMERA["target"])
        statue = (*view, "--light", run.data / LUCY, "--light-scale", "0.001", "--place", "0.5", "0", "4")
        television = (*view, "--light", screen, "--place", "0.5", "0", "1")
        shadows = ("--bounces", "0")
        asked += [("living room, Lucy moving", (*plain, *statue)),
                  ("living room, Lucy moving, all bounces", statue),
                  ("living room, Lucy moving, volume watched too", (*plain, *statue, "--volume")),
                  ("living room, Lucy moving, volume watched too, all bounces", (*statue, "--volume")),
                  ("living room, Lucy deforming at 10 Hz", (*plain, *statue, "--deform", "--rate", "10")),
                  ("living room, Lucy moving, PROPAGATE", (*plain, *statue, "--transport", "propagate")),
                  ("living room, Lucy moving, shadows", (*statue, *shadows)),
                  ("living room, television moving", (*plain, *television)),
                  ("living room, television moving, shadows", (*television, *shadows)),
                  ("living room, television moving, shadows, volume alone", (*television, *shadows, "--volume-only")),
                  ("living room, camera moving, shadows", (*television, *shadows, "--orbit")),
                  ("living room, television moving, all bounces", television)]
        compared |= {name: (run.data / ROOM, ROOM_CAMERA) for name, _ in asked if "living room" in name and "all bounces" in name}
    seconds = ("--warm-up", "1", "--seconds", "1") if run.size == "smoke" else ("--seconds", str(run.seconds))
    rows = []
    for i, (name, flags) in enumerate(asked[:1] if run.size == "smoke" else asked):
        still = folder / f"still{i}"
        row, = run.bench(folder, "service_bench", "--row", name, *seconds, *flags, *(("--still", still) if name in compared else ()))
        if name in compared:
            row["values"].update(stream_errors(run, still, *compared[name]))
        rows.append(row)
    return rows


def stream_errors(run, still, base, view):
    """How far off what the stream shows is; nothing where no references can be made."""
    if importlib.util.find_spec("OpenImageIO") is None or not (run.build / "bin/reference_renderer").is_file():
        return {}
    import references
    import streamed
    return streamed.errors(still, base, view, references.Embree(run.build / "bin/reference_renderer", ROOT / "build/evaluation/cache"))


def streams(run, folder):
    return [row for grid in run.by_size("16", "16 32")
            for row in run.bench(folder, "stream_bench", "--grid", grid, *run.by_size("--results 10 --readers 1", "--still 30"))]


def fairness(run, folder):
    if run.size == "smoke":
        raise LeftOut("sessions side by side take minutes, so the smoke form leaves them out")
    return run.bench(folder, "fairness_bench", "--ticks", *run.by_size("20", "20 --large frame", "60"))


def stability(run, folder):
    run.program("stability")
    document = run.script(folder, "stability/measure", "--markdown", folder / "STABILITY.md")
    return document["rows"], document["skipped"]


def cie(run, folder):
    if importlib.util.find_spec("OpenImageIO") is None:
        raise (LeftOut if run.size == "smoke" else Failed)("OpenImageIO for Python is missing; apt-get install python3-openimageio")
    document = run.script(folder, "evaluation/cie171", *run.by_size("--filter 5.3", ""))
    return document["rows"], document["skipped"]


PARTS = (Part("paper", "the paper's Table 1: dense samples against voxelization", paper),
         Part("pictures", "its figures 5 and 6, beside the truth", paper_pictures),
         Part("transports", "time against error of every transport, grid, opening ratio and lookup", transports),
         Part("lookups", "what lookups make of exact moments", lookups),
         Part("frames", "frames and irradiance against path-traced references, by flags", frames),
         Part("edges", "what samples per pixel leave of edges", edges),
         Part("coding", "bytes on the wire against error", coding),
         Part("steadiness", "power, what arrives with the first tick, how evenly light changes", steadiness),
         Part("stages", "stages of a tick", stages),
         Part("features", "what each feature adds to time and memory", features),
         Part("scale", "time and memory by triangles, lights, surfaces, cells, sessions, readers", scale),
         Part("service", "rates and latency over the loopback", service),
         Part("streams", "slow lines, slow readers, many readers", streams),
         Part("fairness", "a small session beside large ones", fairness),
         Part("stability", "hard cases, each with its bound", stability),
         Part("cie", "the analytic cases of CIE 171:2006", cie))


def measured(part, run):
    """The part's document, written into its folder."""
    folder = run.output / "parts" / part.name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "log.txt").unlink(missing_ok=True)
    run.device = {"choice": "auto", "driver": ""}
    skipped = []
    try:
        found = part.measure(run, folder)
        rows, skipped = found if isinstance(found, tuple) else (found, [])
    except (Failed, OSError, ImportError, ValueError) as error:
        rows, skipped = [], [{"case": part.name, "reason": str(error), "left_out": isinstance(error, LeftOut)}]
    content = results.document(part.name, run.device, rows, skipped)
    results.write(folder, content)
    return content
