"""Reads results.json files and joins them to one document of the same schema, whose rows say which run they are of."""

import json
import os
import re

import results

# What neither XML nor a terminal can show, and halves of surrogate pairs.
NOT_TEXT = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
HEAD = ("bench", "date", "commit", "machine", "device")
OPTIONAL = {"camera": str, "against": str, "picture": str, "images": dict, "reference": dict}


class Wrong(Exception):
    """A file is not there or not as results.schema.md says."""


def clean(value):
    """The same with texts, names included, that can be written anywhere."""
    if isinstance(value, str):
        return NOT_TEXT.sub("\ufffd", value)
    if isinstance(value, dict):
        return {clean(key): clean(v) for key, v in value.items()}
    return [clean(v) for v in value] if isinstance(value, list) else value


def problems(content):
    """Sentences about what is not as the schema says, as far as the report depends on it."""
    if not isinstance(content, dict):
        return ["it is no JSON object"]
    if content.get("schema") != results.SCHEMA:
        return [f"schema is {content.get('schema')!r}, and {results.SCHEMA} is what can be read here; measure again"]
    wrong = results.check(content)
    for i, row in enumerate(content["rows"] if not wrong else []):
        wrong += [f"rows[{i}].{key} is no {kind.__name__}" for key, kind in OPTIONAL.items()
                  if not isinstance(row.get(key, kind()), kind)]
    return wrong


def read(path):
    """The document of a folder or file, and the folder that its pictures are relative to."""
    file = path / "results.json" if path.is_dir() else path
    try:
        content = json.loads(file.read_bytes())
    except OSError as error:
        raise Wrong(f"{path}: {error.strerror}; give a folder that tests/evaluation/evaluate or a bench wrote, "
                    "or its results.json") from None
    except ValueError as error:
        raise Wrong(f"{file} is no JSON: {error}; measure again") from None
    wrong = problems(content)
    if wrong:
        more = f", and {len(wrong) - 3} more" if len(wrong) > 3 else ""
        raise Wrong(f"{file} is not as results.schema.md says: {'; '.join(wrong[:3])}{more}")
    return results.without_nan(clean(content)), file.parent


def relative(row, source, output):
    """The row with the paths of its pictures relative to the folder `output`."""
    def moved(path):
        return os.path.relpath((source / path).resolve(), output.resolve())
    row = dict(row)
    if row.get("picture"):
        row["picture"] = moved(row["picture"])
    if row.get("images"):
        row["images"] = {name: moved(path) for name, path in row["images"].items() if isinstance(path, str)}
    return row


def runs_of(content):
    """The runs that a document holds: itself, or those that it was joined from."""
    return [run for run in content.get("runs", []) if isinstance(run, dict)] or [{key: content[key] for key in HEAD}]


def agreed(values, otherwise):
    """What all say, field by field for objects; `otherwise` where they differ."""
    if all(value == values[0] for value in values):
        return values[0]
    if all(isinstance(value, dict) for value in values):
        keys = dict.fromkeys(key for value in values for key in value)
        return {key: agreed([value.get(key) for value in values], None) for key in keys}
    return otherwise


def joined(sources, output):
    """One document of several (document, folder). A row's `run` is its place in `runs`."""
    runs, rows, skipped = [], [], []
    for content, folder in sources:
        first = len(runs)
        runs += runs_of(content)
        for row in content["rows"]:
            run = row.get("run", 0)
            inside = isinstance(run, int) and 0 <= run < len(runs) - first
            rows.append({**relative(row, folder, output), "run": first + (run if inside else 0)})
        skipped += content["skipped"]
    return {"schema": results.SCHEMA, "bench": agreed([run["bench"] for run in runs], "several"),
            "date": max(run["date"] for run in runs), "commit": agreed([run["commit"] for run in runs], ""),
            "machine": agreed([run["machine"] for run in runs], {}), "device": agreed([run["device"] for run in runs], {}),
            "rows": rows, "skipped": skipped, "runs": runs}
