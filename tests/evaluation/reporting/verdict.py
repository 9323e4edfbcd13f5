"""The section on what became worse since an earlier run."""

from reporting import kinds, page, rows


def changes(caption, listed):
    lines = [[page.words(change.row["case"], True), page.words(change.row.get("camera", "")), page.words(change.row["quantity"]),
              page.words(change.row.get("against", "")), page.words(rows.configuration(change.row, list(rows.asked(change.row)))),
              page.words(kinds.title(change.name)), page.figure_cell(change.old), page.figure_cell(change.new), ratio(change),
              *([] if change.least is None else [page.figure_cell(change.least)])] for change in listed]
    judged = listed[0].least is not None
    return page.table(caption, ["case", "view", "quantity", "against", "settings", "figure", "was", "is", "ratio",
                                *(["more allowed"] if judged else [])], lines)


def ratio(change):
    return page.figure_cell(change.new / change.old if change.old and change.new is not None else None)


def differing(before, after):
    """The settings of two rows that differ, as a sentence."""
    keys = [key for key in dict.fromkeys([*before["settings"], *after["settings"]])
            if key != "expected_error" and before["settings"].get(key) != after["settings"].get(key)]
    said = ", ".join(f"{key} was {rows.setting(key, before['settings'].get(key))}, is {rows.setting(key, after['settings'].get(key))}"
                     for key in keys)
    return f"{rows.named(after)}, {after['quantity']}: {said}"


def section(verdict, old):
    commit, date = old["commit"][:12] or "not known", old["date"][:10]
    parts = [page.paragraph(f"Compared with commit {commit} of {date}: {verdict.compared} errors, bytes and counts. Named is what",
                            "grew by more than 1\u00a0% of its value and by more than the reference's noise and rounding. Times are",
                            "not judged.")]
    if not verdict.compared:
        parts.append(page.paragraph("No measurement of the earlier run is in this one, so nothing could be judged."))
    elif verdict.worse:
        parts.append(f"<p><strong>{len(verdict.worse)} became worse.</strong></p>")
        parts.append(changes("Worse", verdict.worse))
    else:
        parts.append(page.paragraph("Nothing became worse."))
    if verdict.gone:
        parts.append(page.paragraph(f"{len(verdict.gone)} measurements of the earlier run are not in this one:") +
                     page.bullets(sorted({f"{rows.named(row)}, {row['quantity']}" for row in verdict.gone})))
    if verdict.added:
        parts.append(page.paragraph(f"{len(verdict.added)} measurements are new and have nothing to be compared with."))
    if verdict.settings:
        parts.append(page.folded("Settings that differ where the same was asked for",
                                 page.bullets(dict.fromkeys(differing(*pair) for pair in verdict.settings))))
    if verdict.better:
        parts.append(page.folded(f"{len(verdict.better)} became better", changes("Better", verdict.better)))
    if verdict.times:
        parts.append(page.folded(f"{len(verdict.times)} times, not judged", changes("Times", verdict.times)))
    kind = "verdict worse" if verdict.worse else "verdict"
    return page.section("change", "Change since the earlier run", f'<div class="{kind}">', *parts, "</div>")
