"""The report's sections. Each says in a sentence what it shows, or that it was not measured and how it would be."""

import collections

from reporting import figures, front, kinds, page, rows, viewers

NEAR = 1.5  # times the noise: what is below says little, since errors and noise add as squares


def several(listed):
    return len({row["run"] for row in listed}) > 1


def run_column(listed):
    return ["run"] if several(listed) else []


def run_cell(listed, row):
    return [page.words(row["run"] + 1)] if several(listed) else []


def with_noise(values, name, shown):
    value, noise = values.get(name), kinds.noise(values, name)
    return page.figure_cell(value, shown, noise, near=value is not None and noise is not None and value < NEAR * noise)


def sized(row):
    return "x".join(map(str, row["size"])) if isinstance(row.get("size"), list) else ""


TOLD = (("commit", lambda run: run["commit"][:10]), ("date", lambda run: run["date"].replace("T", " ")[:16]), ("machine", lambda run: machine_of(run)),
        ("driver", lambda run: run["device"].get("driver")), ("device", lambda run: run["device"].get("choice")))


def head(content):
    """What was measured where, when and with what: said once where it is the same for all, else by run."""
    runs = content["runs"]
    said = {name: [str(told(run) or "not known") for run in runs] for name, told in TOLD}
    same = [(name, values[0]) for name, values in said.items() if len(set(values)) == 1]
    measured = []
    for i, run in enumerate(runs):
        counted = collections.Counter(row["quantity"] for row in content["rows"] if row["run"] == i)
        what = ", ".join(f"{count} rows of {quantity}" for quantity, count in counted.items()) or "no rows"
        measured.append(f"{run['bench']}: {what}")
    if len(runs) == 1:
        same.append(("measured", measured[0]))
    note = ""
    if len({machine_of(run) for run in runs}) > 1 or not one_driver([run["device"].get("driver") for run in runs]):
        note = page.paragraph("The runs are of different machines or drivers: their times cannot be compared.")
    elif len(set(said["commit"])) > 1:
        note = page.paragraph("The runs are of different commits.")
    listed = "".join(f"<dt>{page.text(name)}</dt><dd>{page.text(value)}</dd>" for name, value in same)
    differ = [name for name, values in said.items() if len(set(values)) > 1]
    lines = [[page.words(i + 1, True), page.words(measured[i]), *(page.words(said[name][i]) for name in differ)] for i in range(len(runs))]
    by_run = page.table("Runs", ["run", "measured", *differ], lines) if len(runs) > 1 else ""
    return f'<dl class="head">{listed}</dl>{note}{by_run}'


def one_driver(drivers):
    """Whether all are the same one, of which some benches tell the renderer and others all that the driver says; those that
    have no device say nothing."""
    told = sorted({driver for driver in drivers if driver and not driver.startswith("no device")}, key=len)
    return all(told[0] in driver for driver in told)


def machine_of(run):
    machine = run["machine"]
    named = [str(machine[key]) for key in ("processor", "system", "architecture") if machine.get(key)]
    return ", ".join([*named, f"{machine['cores']} cores"] if machine.get("cores") else named)


SUMMARY = (("irradiance", "raw_l2", "E: raw L2 %", page.percent), ("irradiance", "nrmse", "E: NRMSE %", page.percent),
           ("pixels", "nrmse", "frame: NRMSE %", page.percent), ("pixels", "nrmse_shadowed", "shadowed: NRMSE %", page.percent),
           ("pixels", "log_ratio_p95", "p95 of |ln|", page.short),
           ("pixels", "share_over_10_percent", "> 10 % off, %", page.percent), ("pixels", "hdr_flip", "FLIP", page.short),
           ("pixels", "frame_seconds", "frame, s", page.short))


def summary(content):
    """A line for each scene and camera, against the reference with the most bounces. The analytic cases have none of its
    figures, and a section of their own."""
    cases = collections.defaultdict(dict)
    shown = [row for row in content["rows"] if any(row["quantity"] == quantity and name in row["values"] for quantity, name, *_ in SUMMARY)]
    for row in rows.foremost(shown):
        cases[(row["run"], *rows.place(row), rows.configuration(row, ()))][row["quantity"]] = row
    if not cases:
        return page.section("summary", "Summary", page.paragraph(
            "Frames and irradiance are not measured in these results; tests/evaluation/evaluate compares them with references."))
    listed = [next(iter(found.values())) for found in cases.values()]
    differ = len({flags for *_, flags in cases}) > 1
    lines = []
    for (_, case, camera, flags), found in cases.items():
        row = next(iter(found.values()))
        cells = [with_noise(found[quantity]["values"] if quantity in found else {}, name, shown) for quantity, name, _, shown in SUMMARY]
        lines.append([page.words(case, True), page.words(camera), *run_cell(listed, row), *([page.words(flags)] if differ else []),
                      page.words(row.get("against", "")), *cells])
    table = page.table("Errors against the path-traced reference with the most bounces" +
                       ("" if differ else f"; {rows.configuration(listed[0], ())}"),
                       ["scene", "view", *run_column(listed), *(["flags"] if differ else []), "bounces",
                        *(title for _, _, title, _ in SUMMARY)], lines)
    return page.section("summary", "Summary", page.paragraph(
        "E is irradiance at points of the surfaces, frame the radiance of the picture; shadowed are pixels with less than 95 % of the",
        "direct light that there would be with nothing in the way; > 10 % off is the share of pixels that are off by more. Small print",
        "beside a figure is what the reference's own noise makes of it, where it is known; figures in grey italics are below one and a",
        "half times that and say little."), table)


def pareto_table(group):
    several = len(group.configurations) > 1
    means = {"all scenes, means": group.overall} if several and len(group.places) > 1 else {}
    lines = [[page.words(place, True), page.words(p.configuration), page.figure_cell(p.seconds), page.figure_cell(p.error),
              *([front_cell(p)] if several else [])] for place, points in {**group.places, **means}.items() for p in points]
    return page.table(f"{group.quantity}: every point", ["scene", "configuration", "time, s", group.error_title,
                                                         *(["Pareto front"] if several else [])], lines)


def front_cell(point):
    return f'<td class="front" data-value="{int(not point.best)}">{"on the front" if point.best else ""}</td>'


def group_part(group, drawings):
    """Figures and table of one quantity; the figures' files go into `drawings`."""
    measure = {"tick_seconds": "the tick", "frame_seconds": "what frame get took, from call to answer",
               "served_seconds": "the tick, and 10,000 receivers that read what it made, on one core"}[group.time]
    against = f" against {', '.join(group.against)}" if group.against else ""
    out = [f"<h3>{page.text(group.quantity)}</h3>",
           page.paragraph(f"Time: {measure}. Error: {group.error_title}{against}. Lower and further left is better.")]

    if group.zeros:
        names = ", ".join(dict.fromkeys(map(rows.named, group.zeros)))
        out.append(page.paragraph(f"Not shown, since their time or error is 0: {len(group.zeros)} rows ({names})."))

    def show(name, svg, caption):
        drawings[name] = svg
        out.append(page.drawing(figures.inline(svg), caption))
    if len(group.configurations) == 1:
        out.append(page.paragraph(f"Every scene was measured with one configuration ({group.configurations[0]}), so each front is",
                                  "one point; results of other flags, given together, make fronts."))
        show(group.name, figures.scenes(group), f"{group.quantity}: time and error by scene")
        return out + [page.folded("Every point", pareto_table(group))]
    if len(group.places) > 1 and group.overall:
        show(f"{group.name}-overall", figures.overall(group),
             f"{group.quantity}: geometric means over {len(group.places)} scenes; ringed and joined: the Pareto front")
    elif len(group.places) > 1:
        out.append(page.paragraph("No configuration was measured in every scene, so there is no front over all of them."))
    show(f"{group.name}-scenes", figures.per_scene(group),
         f"{group.quantity}: by scene; ringed and joined: the Pareto front")
    return out + [page.folded("Every point", pareto_table(group))]


def time_and_error(content, drawings):
    groups = front.groups(content)
    if not groups:
        return page.section("time", "Time against error", page.paragraph(
            "No row has both a time (served_seconds, tick_seconds or frame_seconds) and an error, so time against error is not measured."))
    return page.section("time", "Time against error", *[part for group in groups for part in group_part(group, drawings)])


def edges(content, drawings):
    """HDR-FLIP by samples per pixel."""
    lines = collections.defaultdict(dict)
    for row in content["rows"]:
        samples, flip = row["settings"].get("samples"), row["values"].get("hdr_flip")
        if row["quantity"] == "edges" and isinstance(samples, int) and flip is not None:
            lines[(row["run"], *rows.place(row))][samples] = (row, flip)
    if not lines:
        return page.section("edges", "Edges", page.paragraph(
            "Edges are not measured in these results; tests/evaluation/evaluate --edges compares frames of 1 to 16 samples per pixel."))
    counts = sorted({samples for found in lines.values() for samples in found})
    listed = [row for found in lines.values() for row, _ in found.values()]
    table, curves = [], {}
    for found in lines.values():
        row = next(iter(found.values()))[0]
        run = f", run {row['run'] + 1}" if several(listed) else ""
        table.append([page.words(row["case"], True), page.words(row.get("camera", "")), *run_cell(listed, row),
                      *(page.figure_cell(found.get(count, (None, None))[1]) for count in counts)])
        curves[rows.named(row) + run] = [(count, found[count][1]) for count in counts if count in found and found[count][1] > 0]
    svg = figures.curves("edges", {name: points for name, points in curves.items() if points}, "samples per pixel", "HDR-FLIP")
    drawings["edges"] = svg
    return page.section("edges", "Edges", page.paragraph(
        "Mean HDR-FLIP of frames of so many samples per pixel against the means of frames with 64 pixels for each of theirs, of the same",
        "session without shadows and bounces: what edges and textures lose, whatever the light."),
        page.table("HDR-FLIP by samples per pixel", ["scene", "view", *run_column(listed), *map(str, counts)], table),
        page.drawing(figures.inline(svg), "HDR-FLIP by samples per pixel"))


def analytic(content):
    """The analytic cases of CIE 171:2006: what the formula gives, what the server does, and how far these are apart."""
    listed = [row for row in content["rows"] if row["quantity"] == "irradiance" and "formula" in row["values"]]
    if not listed:
        return page.section("analytic", "Analytic cases", page.paragraph(
            "The cases of CIE 171:2006 are not measured in these results; tests/evaluation/cie171 compares them with formulas."))
    lines = [[page.words(row["case"], True), page.words(row["settings"].get("asked", "")), page.figure_cell(row["settings"].get("reflectance")),
              page.figure_cell(row["settings"].get("bounces")), *(page.figure_cell(row["values"].get(name)) for name in ("points", "formula", "ours")),
              *(page.figure_cell(row["values"].get(name), page.percent) for name in ("relative_rms", "relative_worst"))] for row in listed]
    return page.section("analytic", "Analytic cases", page.paragraph(
        "CIE 171:2006, the lighting trade's own test: E at the points of each case by the formula and by Probe, W/m^2, as means over the",
        "points; the error is relative to the formula's value at each. CIE171.md has the reason of each row above 1 %."),
        page.table("CIE 171:2006", ["case", "asked", "reflectance", "bounces", "points", "formula", "ours", "error, rms %", "worst point %"], lines))


def generic(listed, caption):
    """A table of rows of one quantity: the settings that differ, and all values."""
    keys = rows.varying(listed, lambda row: {k: v for k, v in row["settings"].items() if not isinstance(v, (dict, list))})
    beside = [key for key in ("camera", "against") if any(row.get(key) for row in listed)]
    names = list(dict.fromkeys(name for row in listed for name in row["values"]))
    lines = [[page.words(row["case"], True), *(page.words(row.get(key, "")) for key in beside), *run_cell(listed, row),
              *(setting_cell(key, row["settings"].get(key)) for key in keys),
              *(page.figure_cell(row["values"].get(name)) for name in names)] for row in listed]
    same = {key: value for key, value in listed[0]["settings"].items() if key not in keys and not isinstance(value, (dict, list))}
    said = [f"The same in all rows: {', '.join(f'{key} {rows.setting(key, value)}' for key, value in same.items())}."] if same else []
    return [*([page.paragraph(*said)] if said else []),
            page.table(caption, ["case", *beside, *run_column(listed), *(name.replace("_", " ") for name in (*keys, *names))], lines)]


def setting_cell(key, value):
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return page.figure_cell(value)
    return page.words(rows.setting(key, value))


def benches(content, taken=()):
    """Rows of the benches but of the quantities `taken`, a table for each."""
    found = collections.defaultdict(list)
    for row in content["rows"]:
        if row["quantity"] not in (*rows.EVALUATION, *taken):
            found[(content["runs"][row["run"]]["bench"], row["quantity"])].append(row)
    if not found:
        return page.section("benches", "Benches", page.paragraph("No bench's results were given, so times of stages, bytes and",
                                                                 "loads are not in this report; --results takes their folders, too."))
    return page.section("benches", "Benches", *[part for (bench, quantity), listed in found.items() for part in (
        f"<h3>{page.text(f'{bench}: {quantity}')}</h3>", *generic(listed, f"{len(listed)} rows"))])


def every_row(content):
    """All comparisons of the evaluation, folded."""
    parts = []
    for quantity in rows.EVALUATION:
        listed = [row for row in content["rows"] if row["quantity"] == quantity]
        if listed:
            parts.append(page.folded(f"{quantity}: {len(listed)} rows", "\n".join(generic(listed, quantity))))
    sentence = ("Values as results.schema.md names them." if parts else
                "There are no rows of the evaluation in these results.")
    return page.section("rows", "Every comparison", page.paragraph(sentence), *parts)


def pictures(content, folder):
    """A viewer for each scene and camera: frames with the most bounces first, edges last."""
    found = collections.defaultdict(list)
    for row in content["rows"]:
        if row.get("picture") or row.get("images"):
            found[rows.place(row)].append(row)
    parts = []
    for listed in found.values():
        listed.sort(key=lambda row: (row["quantity"] != "pixels", [-n for n in rows.rank(row.get("against", ""))]))
        parts.append(viewers.viewer(rows.named(listed[0]), listed, folder))
    shown = [part for part in parts if part]
    said = []
    if not shown:
        said.append("There are no pictures in these results." if not found else
                    "The pictures that the results name are not where they say, beside results.json; copy them with it.")
    else:
        said.append("The slider moves between ours and the reference, with the mouse in the picture or with the arrow keys.")
        if len(shown) < len(parts):
            said.append(f"{len(parts) - len(shown)} scenes have none: the files that the results name are not there.")
        if any("images" not in row for listed in found.values() for row in listed):
            said.append("Pictures of runs without separate images are shown whole and have no slider.")
    return page.section("pictures", "Pictures", page.paragraph(*said), *shown)


def skipped(content):
    """What was not measured, and why."""
    if not content["skipped"]:
        return page.section("skipped", "Skipped", page.paragraph("Nothing that was asked for was skipped."))
    lines = [[page.words(skip.get("case", ""), True), page.words(skip.get("reason", ""))]
             for skip in content["skipped"] if isinstance(skip, dict)]
    return page.section("skipped", "Skipped", page.table("Not measured", ["case", "reason"], lines))
