"""The documents that tests/evaluation/documents writes: their sentences, and tables of rows."""

import collections
import json
import math

from reporting import measures

Document = collections.namedtuple("Document", "name part text")


def part(folder, name):
    """The results of one part of a full report."""
    return json.loads((folder / "parts" / name / "results.json").read_text())


def about(content):
    machine = content["machine"]
    return (f"Written by `tests/evaluation/full --parts {content['bench']}` and `tests/evaluation/documents`: {content['date'][:10]}, commit\n"
            f"{content['commit'][:9]}{'+' * content['commit'].endswith('+')}, {machine['cores']} cores ({machine['processor']}), {content['device']['driver']}.")


def of(content, *quantities):
    return [row for row in content["rows"] if row["quantity"] in quantities]


class Column:
    """A column: its title, and what of a row stands in it."""

    def __init__(self, title, source, name, digits=None, factor=1.0):
        self.title, self.source, self.name, self.digits, self.factor = title, source, name, digits, factor

    def cell(self, row):
        value = row["case"] if self.source == "case" else row[self.source].get(self.name)
        if value is None:
            return ""
        if self.digits is None or isinstance(value, str):
            return f"{value:.6g}" if isinstance(value, float) else str(value)
        return f"{self.factor * value:.{self.digits}f}"


def case(title):
    return Column(title, "case", "")


def setting(title, name):
    return Column(title, "settings", name)


def value(title, name, digits, factor=1.0):
    return Column(title, "values", name, digits, factor)


def percent(title, name, digits=2):
    return value(title, name, digits, 100.0)


def table(rows, *columns):
    lines = [[column.title for column in columns], *([column.cell(row) for column in columns] for row in rows)]
    return "\n".join(["| " + " | ".join(lines[0]) + " |", "|---" * len(columns) + "|", *("| " + " | ".join(line) + " |" for line in lines[1:])])


def page(title, content, *blocks):
    return "\n\n".join([f"# {title}", about(content), *blocks]) + "\n"


TERMS = """Grid 32 along the longest edge, transport GATHER, quality FAST (PROPAGATE: 32 steps), frames of 640x360 as JPEG; server and clients share the machine, over the
loopback. Latency: from sending an edit to holding the first frame that shows it. Where neither shadows nor bounces are named: with
`--visibility off --bounces 0`."""
RATES = (case("session"), value("surface triangles", "surface_triangles", 0), value("light triangles", "light_triangles", 0),
         value("edits/s", "edits_per_s", 0))


def measured(content):
    return page("Measured", content, f"{TERMS} Stage times are medians per frame.", """The first 3 s of each row are warm-up and not counted. Their slowest edit, "first frame", waits for what a new session needs once; in the
living room mostly for the upload of its meshes and textures to GL and for the first G-buffer (service_bench prints that frame's stages).
NRMSE: of what the stream shows when the light stands still, over all surfaces, against paths with all bounces, 64 for each pixel, whose own
noise is taken out of it.""",
                table(content["rows"], *RATES, value("ticks/s", "ticks_per_s", 1), value("frames/s", "frames_per_s", 1),
                      value("volumes/s", "volumes_per_s", 1), value("latency p50 ms", "latency_p50_ms", 0), value("p95", "latency_p95_ms", 0),
                      value("p99", "latency_p99_ms", 0), value("max", "latency_max_ms", 0), percent("NRMSE %", "nrmse", 1),
                      value("first frame ms", "first_frame_ms", 0),
                      *(value(f"{stage} ms", f"{stage}_ms", 1) for stage in ("voxelize", "gather", "propagate", "emitters", "reflect", "shade"))))


def put_into_readme(file, content):
    """Between the comments <!-- measured .. --> and <!-- /measured -->."""
    lines = file.read_text().split("\n")
    begin, = (i for i, line in enumerate(lines) if line.startswith("<!-- measured"))
    end, = (i for i, line in enumerate(lines) if line == "<!-- /measured -->")
    rows = table(content["rows"], *RATES, value("frames/s", "frames_per_s", 1), value("volumes/s", "volumes_per_s", 1),
                 value("latency p50, ms", "latency_p50_ms", 0), value("p95", "latency_p95_ms", 0), value("p99", "latency_p99_ms", 0))
    text = f"<!-- measured: written by tests/evaluation/documents -->\n{about(content)}\n\n{TERMS} After 3 s of warm-up.\n\n{rows}"
    file.write_text("\n".join([*lines[:begin], *text.split("\n"), *lines[end:]]))


def injection(content):
    methods = ("dense 1", "dense 100", "dense 1000", "raster COUNT", "raster FLUX", "COUNT", "FLUX")
    times = collections.defaultdict(dict)
    for row in content["rows"]:
        times[(row["case"], row["values"]["triangles"], row["settings"]["grid"])][row["settings"]["method"]] = row["values"]
    head = ["mesh", "grid", *methods, "dense 100 / 1000 to COUNT", "in the paper", "FLUX to COUNT", "adding voxels to the field"]
    lines = [head]
    for (mesh, triangles, grid), found in times.items():
        theirs = measures.TABLE_1.get((mesh, grid))
        count = found["COUNT"]
        lines.append([f"{mesh} ({triangles:.0f})", f"{grid}^3", *(f"{found[m]['wall_ms']:.3g} / {found[m]['cpu_ms']:.3g}" for m in methods),
                      " / ".join(f"{found[m]['cpu_ms'] / count['cpu_ms']:.3g}x" for m in ("dense 100", "dense 1000")),
                      " / ".join(f"{theirs[i] / theirs[3]:.3g}x" for i in (1, 2)) if theirs else "",
                      f"{found['FLUX']['cpu_ms'] / count['cpu_ms']:.1f}x", f"{count['inject_wall_ms']:.3g}"])
    rows = "\n".join(["| " + " | ".join(lines[0]) + " |", "|---" * len(head) + "|", *("| " + " | ".join(line) + " |" for line in lines[1:])])
    return page("Injection: the paper's Table 1", content, """One light put into the grid, turned away from the axes, its longest edge 70 % of the grid's. Milliseconds, wall / CPU of all threads,
medians of 9 or more; ratios are of CPU time, the paper's of a GTX 1660. With Mesa's own number of workers, one per core; lpvd asks for
two (`askForSoftwareWorkers`).""", rows)


def pictures(content):
    return page("The paper's figures 5 and 6, diffuse", content, f"""Each light 1 m across in a room of 4 m, {content['rows'][0]['settings']['grid']} cells along an edge, a frame of the walls. MSE is between displayed pictures, against COUNT's
("our method" in the paper); errors are of irradiance against closed forms. All but the last row of a light propagate, as the paper does:
most of the light is lost on the way to the walls, however it was injected. `tests/evaluation/full --parts pictures` leaves the pictures,
and the report shows them.""",
                table(content["rows"], case("light"), setting("method", "method"), value("MSE to COUNT", "mse_to_ours", 6), percent("raw L2 %", "raw_l2"),
                      percent("shape L2 %", "shape_l2"), percent("NRMSE %", "nrmse"), value("FLIP", "hdr_flip", 3), value("tick, light moved, ms", "moved_tick_ms", 0)))


def accuracy(content):
    return page("Time against error", content, """A light a quarter as long as the room, turned, in its middle; no occluders; the truth is the closed form for polygons. Errors are raw
relative L2 over 864 points of the walls, and over 200 random points with random normals two cells and more from the light; "worst" is the
largest error as a share of the largest irradiance; two poses. Times are medians of ticks in which the light has moved and the whole grid is
wanted (frames gather around surfaces only); PROPAGATE takes twice as many steps as the grid has cells along an edge. A receiver costs what
one lookup takes on one CPU core. "Exact moments" is the lookup's own error, of exact moments at the point itself: most of what object points
beside a light as large as it is near are off by. Near emitters and with DIRECT the lights themselves are looked at. The screen is a quad
with a texture of 8 x 8 texels.""",
                table(content["rows"], case("mesh"), setting("grid", "grid"), setting("transport", "transport"), setting("lookup", "lookup"),
                      value("VPLs", "vpls", 0), value("voxelize ms", "voxelize_ms", 1), value("transport ms", "transport_ms", 1),
                      value("receiver us", "receiver_us", 2), percent("walls %", "raw_l2"), percent("worst %", "worst"), value("p95 of \\|ln\\|", "log_ratio_p95", 4),
                      percent("objects %", "objects_raw_l2"), percent("worst %", "objects_worst")))


def lookups(content):
    rows = content["rows"]
    return page("Lookups", content, """What irradiance a lookup makes of exact moments: of those at the receiver itself, which is the lookup's own error, and of those at the centres
of cells, between which it interpolates, linearly or along cubics with the slopes of every moment kept beside it. The light, its two poses, the
864 points of walls and the 200 of objects are those of [ACCURACY.md](ACCURACY.md); objects are two cells of 64^3 and more from the light, in
the last column two cells of 16^3. Near lights the product looks at the lights themselves, up to three cells away; that is not in this table.
KiB: three colours in half floats. Errors alone, in double, so any machine writes the same.""",
                """SH2 and SH3 are the bands as they are; CAP is the uniform cap with the same two bands; ZH3 adds a band 2 about band 1's axis by a fit (Roughton
et al. 2024, 3.4.3); "CAP and rest" adds what band 2 has more than the cap's own. Errors are raw relative L2; "worst" is the largest error as a
share of the largest irradiance.""",
                table(rows, case("mesh"), setting("moments", "moments"), setting("lookup", "lookup"), setting("KiB", "kib"), percent("walls %", "raw_l2"),
                      percent("worst %", "worst"), percent("objects %", "objects_raw_l2"), percent("worst %", "objects_worst"),
                      percent("objects of 16^3 %", "objects_of_16_raw_l2")), said_of_lookups(rows))


def said_of_lookups(rows):
    """What the table says, computed from it."""
    found = {(row["case"], row["settings"]["moments"], row["settings"]["lookup"]): row for row in rows}
    meshes = list(dict.fromkeys(row["case"] for row in rows))
    cap, rest = "CAP", "CAP and rest of band 2"

    def error(mesh, moments, lookup, name="objects_raw_l2"):
        return found[(mesh, moments, lookup)]["values"][name]

    factors = {mesh: error(mesh, "64^3", cap) / error(mesh, "64^3", rest) for mesh in meshes}
    verdict = ("should carry them: at least twice as good for all" if min(factors.values()) >= 2
               else "carry four, and CAP is the default: twice as good for all was the condition")
    slopes = ", ".join(f"{mesh} {100 * error(mesh, '16^3 with slopes', cap, 'objects_of_16_raw_l2'):.2f} and "
                       f"{100 * error(mesh, '32^3', cap, 'objects_of_16_raw_l2'):.2f}" for mesh in meshes)
    kib = [found[(meshes[0], moments, cap)]["settings"]["kib"] for moments in ("16^3 with slopes", "32^3")]
    floors = [max((error(mesh, "at the receiver", lookup), mesh) for mesh in meshes) for lookup in (cap, rest)]
    return (f"Nine coefficients make objects at 64^3 better by these factors: {', '.join(f'{mesh} {f:.1f}' for mesh, f in factors.items())}. Volumes {verdict}.\n"
            f"Slopes at 16^3 ({kib[0]:.0f} KiB) beside 32^3 without ({kib[1]:.0f} KiB), objects of 16^3, CAP, %: {slopes}.\n"
            f"Four numbers cannot tell objects beside a light better than {100 * floors[0][0]:.1f} % ({floors[0][1]}), nine not better than "
            f"{100 * floors[1][0]:.1f} % ({floors[1][1]}), whatever the grid.")


def coding(content):
    columns = (setting("coding", "coding"), value("kB per result", "bytes", 1, 1e-3), value("Mbit/s at 30/s", "mbit_per_s_at_30", 2),
               value("encode ms", "encode_ms", 1), value("decode ms", "decode_ms", 1), percent("added L2 of irradiance %", "irradiance_l2", 3),
               percent("worst cell %", "worst_cell"), percent("its fluence %", "worst_fluence"))
    blocks = [block for name in ("moving", "still") for block in
              (f"## {name.capitalize()}", table([row for row in content["rows"] if row["case"] == name], *columns))]
    return page("What a volume costs on the wire", content, """The windows of a living room and a television of three colours, GATHER, 32^3 cells. Bytes are payloads. Times are CPU times of one core, medians;
encoding includes what is done once per result for all readers (publishing), decoding the checksum and the floats. Errors are those that the
coding adds, the largest of all results: relative L2 of irradiance (lookup CAP) over all cells and the six axis normals; the largest such
difference of one cell and colour, relative to its own fluence, and that of its fluence, over cells above 1e-5 of the largest. zfp 1.0 packs each
coefficient as a field of floats, to so much of the largest (libzfp, fixed accuracy).""",
                "Deltas are each relative to the result before; the key frame that they start from is not counted.", *blocks)


def steadiness(content):
    moments = (case("light"), setting("grid", "grid"), setting("way", "way"))
    return page("Steadiness", content, "## Power", "What injection puts into the grid, of what the light sends. COUNT and dense samples count cells and hits, as the paper does; FLUX counts area.",
                table(of(content, "power"), *moments, value("share", "share", 3), Column("off by", "values", "power_error")),
                "## First tick", "The share of a moved light's change that its first tick leaves out, against a session that never saw the light elsewhere.",
                table(of(content, "first tick"), *moments, Column("missing", "values", "missing_error")),
                "## Flicker", "A light moves by a tenth of a cell a step: the second difference of (ours - truth) on the walls, relative to the truth there.",
                table(of(content, "flicker"), *moments, percent("rms %", "second_difference_rms_error", 3), percent("worst %", "second_difference_worst", 2)),
                "## Creeping light", """A lamp creeps past an edge by a hundredth of a cell a step: the same, of what the receiver would get with nothing in the way. Asked were .5 % in
volumes and 2 % in frames. Whether a cell sees a light is told by few rays, and a ray that is let through at last counts at once. Streams
send half of the rays, to the same places from every pixel.""",
                table(of(content, "creeping light"), case("asked by"), setting("grid", "grid"), percent("rms %", "second_difference_rms_error", 3),
                      percent("95 % below", "second_difference_p95_error", 3), percent("99 % below", "second_difference_p99_error", 3),
                      percent("worst %", "second_difference_worst", 2), percent("raw error %", "raw_l2")))


def features(content):
    blocks = []
    for name in dict.fromkeys(row["case"] for row in content["rows"]):
        blocks += [f"## {name.capitalize()}", table([row for row in content["rows"] if row["case"] == name], setting("asked", "asked"), value("ms", "tick_ms", 1),
                                                    value("times the volume's tick", "times_the_volumes_tick", 1), value("light MiB", "light_bytes", 2, 2.0 ** -20),
                                                    value("frames MiB", "frames_bytes", 2, 2.0 ** -20))]
    return page("What features add", content, """To a tick, to a frame of 320x180 and to memory: medians of 9 ticks in which the lamp moves, 32 cells. Gloss: every surface has roughness .3. Haze: a tenth in a metre.
Volumes hold direct light, so bounces add nothing to them; what a frame's bounces take counts as light.""", *blocks)


def scale(content):
    blocks = []
    for name in dict.fromkeys(row["case"] for row in content["rows"]):
        rows = [row for row in content["rows"] if row["case"] == name]
        points = [(row["settings"]["count"], row["values"].get("tick_ms") or row["values"].get("processor_ms")) for row in rows]
        points = [(x, y) for x, y in points if y]
        exponent, steep = measures.exponent(points), measures.steep_from(points) if len(points) > 1 else None
        said = f"Exponent over all: {exponent:.2f}. " if exponent is not None and not math.isnan(exponent) else ""
        said += f"More than linear from {steep[0]:.0f} on ({steep[1]:.2f})." if steep else "Nowhere more than linear."
        columns = ((value("server's processors, ms a tick", "processor_ms", 1),) if rows[0]["values"].get("processor_ms") else
                   (value("tick ms", "tick_ms", 1), value("first tick ms", "first_tick_ms", 1), value("voxelize ms", "voxelize_ms", 2),
                    value("in the first tick", "first_voxelize_ms", 2), value("light MiB", "light_bytes", 2, 2.0 ** -20),
                    value("frames MiB", "frames_bytes", 2, 2.0 ** -20)))
        blocks += [f"## {name[0].upper()}{name[1:]}", said, table(rows, setting("count", "count"), *columns)]
    return page("Growth", content, """One thing grows at a time; in every tick one light moves, or one of each session; medians. Light is 32^3 cells where nothing else is said, 16^3
for each of many sessions; no shadows or bounces but with surfaces. Readers are subscribers to one COMPACT volume.""", *blocks)


def streams(content):
    return page("Streams over slow lines, to slow readers, to many", content, "COMPACT volumes of a room whose light moves 30 times a second; results a second, and how old each is when it is there.",
                table(of(content, "streams"), setting("cells", "grid"), case("reader"), value("results/s", "results_per_s", 1),
                      value("age p50 ms", "age_p50_ms", 0), value("age max ms", "age_max_ms", 0)),
                "Many readers of one volume: it is encoded once.",
                table(of(content, "readers"), setting("cells", "grid"), setting("readers", "readers"), value("results a tick", "results_a_tick", 1),
                      value("encodings a tick", "encodings_a_tick", 2), value("server's processors, ms a tick", "processor_ms", 1)),
                "Nobody edits, two subscribers.",
                table(of(content, "static session"), setting("cells", "grid"), setting("seconds", "seconds"), percent("of a core, %", "share_of_a_core", 2)))


def fairness(content):
    return page("A small session beside large ones", content, """A quad as light, 32^3, GATHER, a frame of 640x360: milliseconds from one of its ticks to the next, alone and beside a session whose light moves
in every tick; medians of 60. "Back to back": the next tick is asked for when the last is there; "paced": at most 30 a second, as sessions do.
The statue is Lucy, 33,446 triangles. "Largest admitted": as many of them as `--max-tick-seconds` lets a session have.""",
                table(of(content, "fairness"), case("beside"), setting("its lights", "lights"), setting("small session's ticks", "small session's ticks"),
                      value("alone ms", "alone_ms", 1), value("beside ms", "beside_ms", 1), value("times", "times", 2), value("longest alone", "alone_longest_ms", 1),
                      value("longest beside", "beside_longest_ms", 1), value("its ticks ended", "large_ticks", 0),
                      value("its longest piece ms", "large_longest_piece_ms", 1), value("largest prediction ms", "largest_prediction_ms", 1)),
                "The large sessions alone: the first tick compiles programs.",
                table(of(content, "large session alone"), case("session"), setting("lights", "lights"), setting("tick", "tick"), value("ms", "tick_ms", 0),
                      value("predicted ms", "predicted_ms", 0), value("longest piece ms", "longest_piece_ms", 1), setting("of", "longest piece is of"),
                      value("pieces", "pieces", 0)))


DOCUMENTS = (Document("MEASURED", "service", measured), Document("INJECTION", "paper", injection), Document("PICTURES", "pictures", pictures),
             Document("ACCURACY", "transports", accuracy), Document("LOOKUPS", "lookups", lookups), Document("CODING", "coding", coding),
             Document("STEADINESS", "steadiness", steadiness), Document("FEATURES", "features", features), Document("SCALE", "scale", scale),
             Document("STREAMS", "streams", streams), Document("FAIRNESS", "fairness", fairness))
