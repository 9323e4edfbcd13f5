"""results.json and results.csv, as results.schema.md describes them."""

import csv
import datetime
import json
import math
import os
import pathlib
import platform
import subprocess

SCHEMA = 1
ROOT = pathlib.Path(__file__).resolve().parents[2]


def machine():
    model = ""
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                model = line.split(":", 1)[1].strip()
                break
    except OSError:
        pass
    return {"system": platform.system(), "architecture": platform.machine(), "processor": model, "cores": os.cpu_count()}


def commit():
    """The checked-out commit, with "+" where tracked files differ from it; "" without git."""
    def git(*arguments):
        return subprocess.run(["git", "-C", ROOT, *arguments], capture_output=True, text=True).stdout.strip()
    name = git("rev-parse", "HEAD")
    return name + ("+" if name and git("status", "--porcelain", "--untracked-files=no") else "")


def document(bench, device, rows, skipped=()):
    return {"schema": SCHEMA, "bench": bench, "date": datetime.datetime.now(datetime.timezone.utc).isoformat("T", "seconds"),
            "commit": commit(), "machine": machine(), "device": device, "rows": list(rows), "skipped": list(skipped)}


def without_nan(value):
    """JSON has no nan: null."""
    if isinstance(value, dict):
        return {key: without_nan(v) for key, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [without_nan(v) for v in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write(folder, content):
    """results.json, and results.csv with a line per row and a column per setting and value."""
    folder.mkdir(parents=True, exist_ok=True)
    content = without_nan(content)
    (folder / "results.json").write_text(json.dumps(content, indent=1) + "\n")
    flat = [{**{k: v for k, v in row.items() if not isinstance(v, (dict, list))},
             **{f"{part}.{k}": v for part in ("settings", "reference", "values") for k, v in row.get(part, {}).items()
                if not isinstance(v, (dict, list))}} for row in content["rows"]]
    columns = list(dict.fromkeys(key for row in flat for key in row))
    with open(folder / "results.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(flat)


def percent(value):
    return "-" if value is None or value != value else f"{100.0 * value:.2g}"  # what is not a number was not measured


def provenance(content):
    return (f"{content['machine']['processor']}, {content['machine']['cores']} cores; {content['device'].get('driver', '')}; "
            f"commit {content['commit'][:12]}, {content['date'][:10]}")


def converged(content):
    """Markdown: what light with all bounces is off by, a line per scene and camera. Noise is that of the reference: what
    an exact answer would be off by."""
    head = ["scene", "view", "flags", "E: raw L2 %", "E: NRMSE %", "E: noise %", "frame: NRMSE %", "frame: noise %",
            "shadowed NRMSE %", "p95 of \\|ln\\|", "> 10 % off", "FLIP", "frame, s"]
    lines = [provenance(content), "", f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    cases = {}
    for row in content["rows"]:
        if row.get("against") == "all":
            cases.setdefault((row["case"], row["camera"]), {})[row["quantity"]] = row
    for (case, camera), rows in cases.items():
        e, frame = (rows.get(quantity, {"values": {}})["values"] for quantity in ("irradiance", "pixels"))
        flags = next(iter(rows.values()))["settings"]["flags"] or "-"
        shares = [percent(values.get(key)) for values, key in (
            (e, "raw_l2"), (e, "nrmse"), (e, "nrmse_of_reference"), (frame, "nrmse"), (frame, "nrmse_of_reference"),
            (frame, "nrmse_shadowed"))]
        plain = [f"{frame[key]:.2g}" if frame.get(key) is not None else "-"
                 for key in ("log_ratio_p95", "share_over_10_percent", "hdr_flip", "frame_seconds")]
        lines.append(f"| {case} | {camera} | {flags} | " + " | ".join(shares + plain) + " |")
    return "\n".join(lines) + "\n"


def unshadowed(content):
    """Markdown: what direct light with nothing in the way is off by, a line per scene and camera."""
    lines = [provenance(content), "",
             "| scene | view | cells | quality | k | flags | announced % | E: raw L2 % | E: NRMSE % | frame: raw L2 % | frame: NRMSE % |",
             "|---|---|---|---|---|---|---|---|---|---|---|"]
    cases = {}
    for row in content["rows"]:
        if row.get("against") == "unoccluded":
            cases.setdefault((row["case"], row["camera"]), {})[row["quantity"]] = row
    for (case, camera), rows in cases.items():
        settings = next(iter(rows.values()))["settings"]
        values = [rows.get(quantity, {"values": {}})["values"].get(key)
                  for quantity in ("irradiance", "pixels") for key in ("raw_l2", "nrmse")]
        quality = settings["quality"].removeprefix("QUALITY_").lower()
        lines.append(f"| {case} | {camera} | {settings['grid_dims']} | {quality} | {settings['k'] or 'by quality'} | "
                     f"{settings['flags'] or '-'} | " + " | ".join(map(percent, [settings.get("expected_error"), *values])) + " |")
    return "\n".join(lines) + "\n"


def gloss(content):
    """Markdown: what the surfaces with lobes are off by, a line per scene and kind of surface; "" where there are none."""
    lines = [provenance(content), "", "| scene | roughness | metalness | pixels | ours over truth | raw L2 % | NRMSE % | noise % | the paper's over truth | its NRMSE % |",
             "|---|---|---|---|---|---|---|---|---|---|"]
    papers = {(row["case"], row["quantity"].removeprefix("the paper's ")): row["values"] for row in content["rows"]
              if row["quantity"].startswith("the paper's gloss")}
    for row in content["rows"]:
        if not row["quantity"].startswith("gloss, roughness"):
            continue
        roughness, metalness = (word.split()[-1] for word in row["quantity"].split(", ")[1:])
        v, theirs = row["values"], papers.get((row["case"], row["quantity"]))
        beside = f"{theirs['mean_ours'] / theirs['mean_truth']:.2f} | {percent(theirs['nrmse'])}" if theirs else "- | -"
        lines.append(f"| {row['case']} | {roughness} | {metalness} | {v['pixels']} | {v['mean_ours'] / v['mean_truth']:.3f} | "
                     + " | ".join(percent(v[key]) for key in ("raw_l2", "nrmse", "nrmse_of_reference")) + f" | {beside} |")
    return "\n".join(lines) + "\n" if len(lines) > 4 else ""


def edges(content):
    """Markdown: HDR-FLIP of so many samples per pixel against the finest, a line per scene and camera."""
    cases = {}
    for row in content["rows"]:
        if row["quantity"] == "edges":
            cases.setdefault((row["case"], row["camera"]), {})[row["settings"]["samples"]] = row["values"]["hdr_flip"]
    counts = sorted({samples for values in cases.values() for samples in values})
    head = ["scene", "view", *map(str, counts)]
    lines = [provenance(content), "", f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    for (case, camera), values in cases.items():
        shown = [f"{values[samples]:.2g}" if samples in values else "-" for samples in counts]
        lines.append(f"| {case} | {camera} | {' | '.join(shown)} |")
    return "\n".join(lines) + "\n"


def check(content):
    """Sentences about what is not as results.schema.md says; empty if all is."""
    wrong = []
    for key, kind in (("schema", int), ("bench", str), ("date", str), ("commit", str), ("machine", dict), ("device", dict),
                      ("rows", list), ("skipped", list)):
        if not isinstance(content.get(key), kind):
            wrong.append(f"{key} is missing or no {kind.__name__}")
    for i, row in enumerate(content["rows"] if isinstance(content.get("rows"), list) else []):
        if not isinstance(row, dict):
            wrong.append(f"rows[{i}] is no object")
            continue
        for key, kind in (("case", str), ("quantity", str), ("settings", dict), ("values", dict)):
            if not isinstance(row.get(key), kind):
                wrong.append(f"rows[{i}].{key} is missing or no {kind.__name__}")
        values = row.get("values")
        for key, value in values.items() if isinstance(values, dict) else ():
            if value is not None and not isinstance(value, (int, float)):
                wrong.append(f"rows[{i}].values.{key} is no number")
    return wrong
