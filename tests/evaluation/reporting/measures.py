"""Sections of what benches measure: the paper's table and pictures, bytes against error, steadiness, features, scale."""

import collections
import math

from reporting import figures, front, kinds, page, sections

# The paper's Table 1, milliseconds on a GTX 1660: dense samples, 1, 100 and 1000 a triangle, and its own method.
TABLE_1 = {("quad", 32): (0.007, 0.007, 0.015, 0.024), ("pyramid", 32): (0.007, 0.009, 0.034, 0.024),
           ("tube", 32): (0.007, 0.012, 0.053, 0.025), ("sphere 720", 32): (0.009, 0.235, 2.475, 0.031),
           ("Lucy", 32): (0.132, 9.850, 98.500, 0.307), ("quad", 64): (0.007, 0.007, 0.015, 0.020),
           ("pyramid", 64): (0.007, 0.009, 0.024, 0.020), ("tube", 64): (0.007, 0.016, 0.047, 0.020),
           ("sphere 720", 64): (0.008, 0.140, 1.581, 0.032), ("Lucy", 64): (0.123, 9.250, 91.760, 0.304)}
METHODS = ("dense 1", "dense 100", "dense 1000", "COUNT")
TAKEN = ("injection", "paper's pictures", "coding", "power", "first tick", "flicker", "creeping light", "features", "scale")
NEEDED = {"injection": ("grid", "method"), "paper's pictures": ("grid", "method"), "coding": ("coding",), "scale": ("count",),
          "transport": ("grid", "transport", "lookup")}
LINEAR = 1.15  # the exponent up to which growth is called linear


def of(content, *quantities):
    """Rows that have what the sections here read of them: other programs may write the same quantities."""
    return [row for row in content["rows"] if row["quantity"] in quantities and all(key in row["settings"] for key in NEEDED.get(row["quantity"], ()))]


def ratio_cell(value):
    return page.figure_cell(value, lambda v: page.NOTHING if v is None else f"{v:.1f}x" if v >= 0.1 else f"{v:.2f}x")


def paper(content):
    """Table 1, times here and ratios beside the paper's."""
    listed = of(content, "injection")
    if not listed:
        return page.section("table1", "The paper's Table 1", page.paragraph("Injection is not measured in these results."))
    times = collections.defaultdict(dict)
    for row in listed:
        times[(row["run"], row["case"], row["settings"]["grid"])][row["settings"]["method"]] = row["values"].get("wall_ms")
    lines = []
    for (run, mesh, grid), found in times.items():
        theirs = TABLE_1.get((mesh, grid))
        ratios = []
        for i, method in enumerate(METHODS[:3]):
            here = found[method] / found["COUNT"] if found.get(method) and found.get("COUNT") else None
            ratios += [ratio_cell(here), ratio_cell(theirs[i] / theirs[3] if theirs else None)]
        lines.append([page.words(mesh, True), page.figure_cell(grid), *(page.figure_cell(found.get(m)) for m in (*METHODS, "FLUX")), *ratios])
    return page.section("table1", "The paper's Table 1", page.paragraph(
        "Putting one light into the grid, wall-clock milliseconds. COUNT is the paper's method, FLUX this server's default, which is exact in",
        "power and does not flicker. Ratios are times of dense sampling over COUNT, here and in the paper (GTX 1660)."),
        page.table("Injection", ["mesh", "grid", *(f"{m}, ms" for m in (*METHODS, "FLUX")),
                                 *(f"{m} to COUNT{where}" for m in METHODS[:3] for where in (", here", ", paper"))], lines))


def paper_pictures(content):
    """Figures 5 and 6 as a table; the pictures are among the others."""
    listed = of(content, "paper's pictures")
    if not listed:
        return page.section("figures56", "The paper's figures 5 and 6", page.paragraph("These pictures are not in these results."))
    lines = [[page.words(row["case"], True), page.words(row["settings"]["method"]), page.figure_cell(row["values"].get("mse_to_ours")),
              *(page.figure_cell(row["values"].get(name), page.percent) for name in ("raw_l2", "shape_l2", "nrmse")),
              page.figure_cell(row["values"].get("hdr_flip"), page.short), page.figure_cell(row["values"].get("moved_tick_ms"))] for row in listed]
    return page.section("figures56", "The paper's figures 5 and 6", page.paragraph(
        f"Diffuse light of each mesh in a room, {listed[0]['settings']['grid']:.0f} cells along an edge. MSE is between displayed pictures, against COUNT's,",
        "as the paper tells it; the errors beside it are against the truth, closed forms. The first five methods propagate as the paper",
        "does, which loses most of the light before it is at the walls, however it was injected; the last is this server's default. The",
        "pictures themselves are below, among the others. Panel (b) of figure 6, the specular light of a volume of two bands, is not",
        "built here: the paper says itself that it is not good; glossy surfaces look at the lights themselves (GLOSS.md)."),
        page.table("Errors by light and injection", ["light", "method", "MSE to COUNT", "raw L2 %", "shape L2 %", "NRMSE %", "FLIP",
                                                     "tick, light moved, ms"], lines))


def coding(content, drawings):
    """Bytes on the wire against the error that the coding adds."""
    listed = [row for row in of(content, "coding") if row["case"] == "moving"]
    if not listed:
        return page.section("coding", "Bytes against error", page.paragraph("Codings are not measured in these results."))
    points = [front.Point("moving", row["settings"]["coding"], row["values"]["bytes"], row["values"]["irradiance_l2"], False)
              for row in listed if row["values"].get("bytes") and row["values"].get("irradiance_l2")]
    parts = []
    if points:
        svg = figures.fronts("coding", front.marked(points), "bytes of a result", "added raw L2 of irradiance")
        drawings["coding"] = svg
        parts = [page.drawing(figures.inline(svg), "bytes of a result and the error that its coding adds; ringed and joined: the Pareto front")]
    still = [row for row in of(content, "coding") if row["case"] != "moving"]
    return page.section("coding", "Bytes against error", page.paragraph(
        "Volumes of a room whose television moves, each result after the one before; errors are those that the coding adds, the largest",
        "of all results, to the irradiance of all cells and six normals, and to the worst cell. zfp packs each coefficient as a field of floats, and knows no result before."),
        *parts, *sections.generic(listed, "moving"), *([page.folded("Nothing moves", "\n".join(sections.generic(still, "still")))] if still else []))


def convergence(content, drawings):
    """Errors by cells along an edge, as means over the meshes."""
    lines = collections.defaultdict(lambda: collections.defaultdict(list))
    for row in of(content, "transport"):
        error = row["values"].get("raw_l2")
        if error and row["settings"].get("transport") != "exact moments":
            lines[f"{row['settings']['transport']}, {row['settings']['lookup']}"][row["settings"]["grid"]].append(error)
    curves = {name: [(grid, math.exp(sum(map(math.log, found)) / len(found))) for grid, found in sorted(by_grid.items())]
              for name, by_grid in lines.items()}
    curves = {name: points for name, points in curves.items() if len(points) > 1}
    if not curves:
        return [page.paragraph("Transports were not measured on several grids, so there is no convergence to show.")]
    svg = figures.curves("convergence", curves, "cells along an edge", "raw L2 on walls")
    drawings["convergence"] = svg
    rows_of_table = [[page.words(name, True), *(page.figure_cell(dict(points).get(grid), page.percent) for grid in grids_of(curves)),
                      page.figure_cell(exponent(points))] for name, points in curves.items()]
    return [page.drawing(figures.inline(svg), "raw L2 on walls by cells along an edge, geometric means over the meshes"),
            page.folded("Convergence in numbers", page.table("raw L2 on walls, %", ["transport", *(f"{g:.0f}^3" for g in grids_of(curves)),
                                                                                    "exponent"], rows_of_table))]


def grids_of(curves):
    return sorted({x for points in curves.values() for x, _ in points})


def steadiness(content, drawings):
    listed = of(content, "power", "first tick", "flicker", "creeping light")
    if not listed and not of(content, "transport"):
        return page.section("steadiness", "Steadiness", page.paragraph("Power, first ticks and flicker are not measured in these results."))
    told = {"power": "Power that injection puts into the grid, as a share of what the light sends.",
            "first tick": "The share of a change that a moved light's first tick leaves out.",
            "flicker": "A light moves by a tenth of a cell a step: second differences of (ours − truth) on the walls, of the truth there.",
            "creeping light": "A lamp creeps past an edge by a hundredth of a cell a step: the same, of the unoccluded irradiance."}
    parts = []
    for quantity, sentence in told.items():
        found = of(content, quantity)
        if found:
            parts += [f"<h3>{page.text(quantity)}</h3>", page.paragraph(sentence), *sections.generic(found, quantity)]
    return page.section("steadiness", "Steadiness", *parts, "<h3>convergence</h3>", *convergence(content, drawings))


def features(content):
    listed = of(content, "features")
    if not listed:
        return page.section("features", "What features cost", page.paragraph("Features are not measured in these results."))
    return page.section("features", "What features cost", page.paragraph(
        "A tick in which one lamp has moved, in a room of walls and in the same room with two boxes; each feature alone or on top of those",
        "before it; GPU memory of the session's light and of its frames."), *sections.generic(listed, "Features"))


def exponent(points):
    """The slope of a straight line through the logarithms; None of fewer than two points."""
    if len(points) < 2 or any(x <= 0 or y <= 0 for x, y in points):
        return None
    logs = [(math.log(x), math.log(y)) for x, y in points]
    mean_x, mean_y = (sum(values) / len(logs) for values in zip(*logs))
    across = sum((x - mean_x) ** 2 for x, _ in logs)
    return sum((x - mean_x) * (y - mean_y) for x, y in logs) / across if across else None


def steep_from(points):
    """The first count from which on a step grows faster than linearly, and that step's exponent; None where none does."""
    for (x0, y0), (x1, y1) in zip(points, points[1:]):
        slope = math.log(y1 / y0) / math.log(x1 / x0)
        if slope > LINEAR:
            return x0, slope
    return None


def scale(content, drawings):
    """Curves by count, with the fitted exponent and where growth stops being linear."""
    listed = of(content, "scale")
    if not listed:
        return page.section("scale", "Scale", page.paragraph("Growth is not measured in these results."))
    times, memory = collections.defaultdict(list), collections.defaultdict(list)
    for row in listed:
        time = row["values"].get("tick_ms", row["values"].get("processor_ms"))
        if time:
            times[row["case"]].append((row["settings"]["count"], time))
        held = sum(row["values"].get(name) or 0 for name in ("light_bytes", "frames_bytes"))
        if held:
            memory[row["case"]].append((row["settings"]["count"], held / 2 ** 20))
    parts, lines = [], []
    for name, found, title in (("scale-time", times, "tick, ms"), ("scale-memory", memory, "GPU memory, MiB")):
        curves = {case: sorted(points) for case, points in found.items() if len(points) > 1}
        if not curves:
            continue
        svg = figures.growth(name, curves, "count", title)
        drawings[name] = svg
        parts.append(page.drawing(figures.inline(svg), f"{title} by count"))
        for case, points in curves.items():
            steep = steep_from(points)
            said = f"from {steep[0]:.0f}, where it grows by an exponent of {steep[1]:.2f}" if steep else "nowhere in what was measured"
            lines.append([page.words(case, True), page.words(title), page.figure_cell(points[0][0]), page.figure_cell(points[-1][0]),
                          page.figure_cell(points[0][1]), page.figure_cell(points[-1][1]), page.figure_cell(exponent(points)), page.words(said)])
    return page.section("scale", "Scale", page.paragraph(
        "One thing grows at a time; in every tick one light moves, or one of each session. The exponent is that of the straight line through",
        "all points of a logarithmic plot: 0 does not grow, 1 grows as the count does. A step counts as more than linear above 1.15."),
        *parts, page.table("Growth", ["what grows", "what is measured", "from", "to", "first", "last", "exponent", "more than linear"], lines),
        page.folded("Every count", "\n".join(sections.generic(listed, "scale"))))
