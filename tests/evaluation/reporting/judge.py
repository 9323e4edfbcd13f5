"""What became worse since an earlier run: errors, bytes and counts are judged, times are shown."""

import collections

from reporting import kinds, rows

Change = collections.namedtuple("Change", "row name old new least")


class Verdict:
    """What a run and an earlier one have in common, and how the values differ."""

    def __init__(self):
        self.worse, self.better, self.times = [], [], []
        self.gone, self.added, self.compared, self.settings = [], [], 0, []


def identity(row, settings):
    reference = row.get("reference", {})
    return (row["case"], row.get("camera", ""), row["quantity"], row.get("against", ""), repr(row.get("size")),
            repr(reference.get("samples")), repr(reference.get("filter")), repr(sorted(settings(row).items(), key=repr)))


def everything(row):
    """All settings but what came out of them: the estimate of the error is no setting."""
    return {key: value for key, value in row["settings"].items() if key != "expected_error"}


def pairs(old, new):
    """(earlier row, row) of the same measurement, what is only in the earlier run, and what is only in the new one. Rows
    whose settings are the same come first; then those for which the same was asked, so that a new default is judged."""
    together = []
    for settings in (everything, rows.asked):
        before = {identity(row, settings): row for row in old}
        both = [(before[identity(row, settings)], row) for row in new if identity(row, settings) in before]
        together += both
        taken = {identity(row, settings) for _, row in both}
        old, new = ([row for row in listed if identity(row, settings) not in taken] for listed in (old, new))
    return together, old, new


def judged(old, new):
    """The verdict on two documents."""
    verdict = Verdict()
    together, verdict.gone, verdict.added = pairs(old["rows"], new["rows"])
    for before, after in together:
        if everything(before) != everything(after):
            verdict.settings.append((before, after))
        for name, value in before["values"].items():
            if value is None or name not in after["values"]:
                continue
            kind = kinds.kind(name)
            if kind == "time":
                verdict.times.append(Change(after, name, value, after["values"][name], None))
            elif kind in kinds.JUDGED:
                verdict.compared += 1
                judge(verdict, before, after, name)
    verdict.times = without_repetition(verdict.times)
    return verdict


def without_repetition(times):
    """One frame is compared with several references: its time is one."""
    return list({(rows.place(c.row), c.row["quantity"], c.name, c.old, c.new): c for c in reversed(times)}.values())[::-1]


def judge(verdict, before, after, name):
    old, new = before["values"][name], after["values"][name]
    least = kinds.threshold(before["values"], after["values"], name)
    if new is None or new - old > least:
        verdict.worse.append(Change(after, name, old, new, least))
    elif old - new > least:
        verdict.better.append(Change(after, name, old, new, least))


def sentence(change):
    """A finding in words, for the terminal."""
    new = "no number" if change.new is None else f"{change.new:.4g}"
    row = change.row
    against = f" against {row['against']}" if row.get("against") else ""
    return (f"{rows.named(row)}, {row['quantity']}{against}: {kinds.title(change.name)} was {change.old:.4g}, is {new}; "
            f"{change.least:.2g} more would pass")
