"""What rows of results have in common: their names, the settings that tell them apart, the reference that counts."""

EVALUATION = ("pixels", "irradiance", "edges")


def place(row):
    """Scene and camera, or the case of a bench."""
    return row["case"], row.get("camera", "")


def named(row):
    case, camera = place(row)
    return f"{case}, {camera}" if camera else case


def asked(row):
    """The settings that were asked for. Rows of the evaluation have flags, and beside them what came of them."""
    settings = {key: value for key, value in row["settings"].items() if not isinstance(value, (dict, list))}
    if "flags" in settings:
        return {key: settings[key] for key in ("flags", "samples") if key in settings}
    return settings


def varying(rows, settings=asked):
    """Names of the settings that are not the same in all rows, in the order in which they come."""
    seen = {}
    for row in rows:
        for key in settings(row):
            seen.setdefault(key, set())
    for row in rows:
        for key, values in seen.items():
            values.add(repr(settings(row).get(key)))
    return [key for key, values in seen.items() if len(values) > 1]


def word(value):
    """A setting as a person says it: TRANSPORT_GATHER is GATHER beside its name."""
    if isinstance(value, float):
        return f"{value:.4g}"
    return "-" if value in (None, "") else str(value)


def setting(key, value):
    text = word(value)
    prefix = key.upper() + "_"
    return text[len(prefix):] if text.startswith(prefix) and len(text) > len(prefix) else text


def told(key, value):
    """A setting on its own: words without its name, numbers with it."""
    return setting(key, value) if isinstance(value, str) and value else f"{key} {setting(key, value)}"


def configuration(row, keys):
    """The settings `keys` of a row as one text."""
    if "flags" in row["settings"]:
        flags = str(row["settings"]["flags"]) or "default flags"
        samples = row["settings"].get("samples")
        return f"{samples} sample{'s' * (samples != 1)}" if "samples" in keys else flags
    return ", ".join(told(key, asked(row).get(key)) for key in keys) or "as it is"


def reference_of(row):
    """What the row is compared with, in words."""
    against = row.get("against", "")
    if against.isdigit():
        return f"{against} bounce{'s' * (against != '1')}" if int(against) else "direct light with shadows"
    return {"all": "all bounces", "unoccluded": "direct light with nothing in the way", "": "its reference"}.get(against, against)


def rank(against):
    """More bounces come first; "unoccluded" and what else is no number of bounces last."""
    return (2, 0) if against == "all" else (1, int(against)) if against.isdigit() else (0, 0)


def foremost(rows):
    """Of every run, scene and camera the rows that are compared with the most bounces."""
    best = {}
    for row in rows:
        key = (row["run"], *place(row), row["quantity"], configuration(row, ()))
        if key not in best or rank(row.get("against", "")) > rank(best[key].get("against", "")):
            best[key] = row
    return list(best.values())
