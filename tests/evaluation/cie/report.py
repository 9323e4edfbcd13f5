"""Rows of results.json and tables of the cases."""

import numpy as np

SMALLEST = 0.01  # of a case's largest value: what relative errors of smaller ones are taken from


def errors(ours, truth):
    """Relative to the truth, or to a hundredth of the largest where that is more."""
    return (ours - truth) / np.maximum(np.abs(truth), SMALLEST * np.abs(truth).max())


def compared(case, answers):
    """(values of the case's row, our values at its points or of its weighted sum)."""
    ours = answers if case.weights is None else np.array([case.weights @ answers])
    off = errors(ours, case.truth)
    values = {"points": len(case.points), "formula": float(np.mean(case.truth)), "ours": float(np.mean(ours)),
              "relative_rms": float(np.sqrt(np.mean(off ** 2))), "relative_worst": float(np.abs(off).max())}
    return values, ours


def rows_of(scene, case, answers, transport, settings):
    """The case's row, then one of each labelled point."""
    values, ours = compared(case, answers)
    volume = errors(case.looked_up, case.truth) if case.looked_up is not None else None
    if volume is not None:
        values.update(exact_volume_rms=float(np.sqrt(np.mean(volume ** 2))), exact_volume_worst=float(np.abs(volume).max()))
    quantity = "irradiance" if case.weights is None else "sum"
    about = {"asked": transport, "reflectance": scene.reflectance, **settings}
    worst = int(np.argmax(np.abs(errors(ours, case.truth))))
    row = {"case": case.name, "quantity": quantity, "says": case.says, "settings": about, "values": values}
    if case.labels:
        row["worst_point"] = case.labels[worst]
    points = [{"case": case.name, "quantity": "point", "point": label, "says": case.says, "settings": about,
               "values": {"formula": float(t), "ours": float(o), "relative_error": float(e)}}
              for label, t, o, e in zip(case.labels, case.truth, ours, errors(ours, case.truth))]
    for point, off in zip(points, volume if volume is not None else ()):
        point["values"]["exact_volume_error"] = float(off)
    return [row, *points]


def markdown(head, lines):
    return "\n".join([f"| {' | '.join(head)} |", "|---" * len(head) + "|", *(f"| {' | '.join(line)} |" for line in lines)])


def number(value):
    return f"{value:.2f}" if value < 1000 else f"{value:.1f}"


def percent(value):
    return f"{100 * value:.2f}"


def geometry(scenes):
    """A line per scene: what it is."""
    lines = []
    for scene in scenes:
        counts = ", ".join(dict.fromkeys(str(len(case.points)) for case in scene.cases))
        lines.append([scene.name, scene.geometry, f"{scene.reflectance:g}", str(scene.bounces), counts])
    return markdown(["scene", "geometry", "reflectance", "bounces", "points"], lines)


def by_case(rows, quantities):
    """{(case, says): {asked: row}} in the rows' order; with a point's label in the key for points."""
    out = {}
    for row in rows:
        if row["quantity"] in quantities:
            key = (row["case"], row["says"], *([row["point"]] if "point" in row else []))
            out.setdefault(key, {})[row["settings"]["asked"]] = row
    return out


def summary(rows, transports):
    """A line per case: the formula's mean, and per transport ours and the errors' root mean square and worst, in percent;
    last, those of the lookup CAP with exact moments."""
    lines = []
    for (name, says), found in by_case(rows, ("irradiance", "sum")).items():
        line = [name, says, number(next(iter(found.values()))["values"]["formula"])]
        for transport in transports:
            values = found[transport]["values"] if transport in found else None
            line.append(f"{number(values['ours'])}; {percent(values['relative_rms'])}; {percent(values['relative_worst'])}" if values else "-")
        values = next(iter(found.values()))["values"]
        line.append(f"{percent(values['exact_volume_rms'])}; {percent(values['exact_volume_worst'])}" if "exact_volume_rms" in values else "-")
        lines.append(line)
    return markdown(["case", "what", "formula", *(f"{t}: ours; rms %; worst %" for t in transports), "exact volume: rms %; worst %"], lines)


def points(rows, transports):
    """A line per labelled point: the formula's value, per transport ours and the error in percent, and that of the lookup CAP
    with exact moments."""
    lines = []
    for (name, _, label), found in by_case(rows, ("point",)).items():
        line = [name, label, f"{next(iter(found.values()))['values']['formula']:.3f}"]
        for transport in transports:
            values = found[transport]["values"] if transport in found else None
            line.append(f"{values['ours']:.3f}; {100 * values['relative_error']:+.2f}" if values else "-")
        volume = next(iter(found.values()))["values"].get("exact_volume_error")
        line.append("-" if volume is None else f"{100 * volume:+.2f}")
        lines.append(line)
    return markdown(["case", "point", "formula", *(f"{t}: ours; error %" for t in transports), "exact volume: error %"], lines)


def skipped(reasons):
    return markdown(["case", "why it is left out"], [list(reason) for reason in reasons])
