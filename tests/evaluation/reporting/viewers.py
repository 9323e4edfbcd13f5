"""Pictures in the page: a slider between ours and the reference, their difference, FLIP, with colour bars."""

import base64
import io

import matplotlib
import PIL.Image

import pictures
from reporting import kinds, page, rows

WIDEST = 640  # pixels of an embedded picture
FIGURES = ("nrmse", "nrmse_shadowed", "log_ratio_p95", "share_over_10_percent", "hdr_flip")
BESIDE = (("difference", pictures.DIFFERENCE, "(ours − reference) / reference"), ("flip", pictures.FLIP, "HDR-FLIP"))
STOPS = 16
HEAD = '<div class="choice"'  # what every comparison begins with


def embedded(path):
    """A data URI of the picture, scaled to WIDEST where it is wider; None where it cannot be read."""
    try:
        with PIL.Image.open(path) as file:
            image = file.convert("RGB")
    except (OSError, ValueError, PIL.Image.DecompressionBombError):
        return None
    if image.width > WIDEST:
        image = image.resize((WIDEST, max(1, round(image.height * WIDEST / image.width))), PIL.Image.Resampling.BOX)
    out = io.BytesIO()
    image.save(out, "WEBP", lossless=True, quality=60, method=4)
    return "data:image/webp;base64," + base64.b64encode(out.getvalue()).decode()


def bar(scale, ticks, what):
    """The colours of a scale with its numbers below."""
    colours = matplotlib.colormaps[scale.colours]
    stops = ", ".join(matplotlib.colors.to_hex(colours(i / (STOPS - 1))) for i in range(STOPS))
    marks = "".join(f"<span>{page.text(tick)}</span>" for tick in ticks)
    return (f'<div class="bar" role="img" aria-label="{page.text(f"Colour bar of {what}, from {ticks[0]} to {ticks[-1]}")}" '
            f'style="background: linear-gradient(to right, {stops})"></div><div class="ticks">{marks}</div>')


def ticks(scale, count=5):
    values = [scale.least + (scale.most - scale.least) * i / (count - 1) for i in range(count)]
    return [f"{100 * v:+.0f} %" if scale.least < 0 and v else f"{v:g}" for v in values]


def image(uri, alt, name=""):
    return f'<img src="{uri}" alt="{page.text(alt)}"{f" class={name}" if name else ""}>'


def numbers(row):
    """The figures of a picture in a line, with the reference's noise."""
    parts = []
    for name in FIGURES:
        value = row["values"].get(name)
        if value is not None:
            shown = page.short if name in ("hdr_flip", "log_ratio_p95") else lambda v: f"{page.percent(v)} %"
            noise = kinds.noise(row["values"], name)
            parts.append(f"{kinds.title(name)} {shown(value)}" + (f" (noise {shown(noise)})" if noise is not None else ""))
    return f'<p class="numbers note">{page.text(": ".join(filter(None, (label(row), "; ".join(parts)))))}</p>'


def beside(uris):
    """The difference and FLIP, each with its bar."""
    out = []
    for name, scale, what in BESIDE:
        if uris.get(name):
            shown = image(uris[name], what) + bar(scale, ticks(scale), what)
            out.append(f"<figure>{shown}<figcaption>{page.text(what)}</figcaption></figure>")
    return f'<div class="beside">{"".join(out)}</div>'


def choice(row, folder):
    """One comparison; None where the row has no picture that can be read."""
    uris = {name: embedded(folder / path) for name, path in row.get("images", {}).items()}
    what = f"{rows.named(row)}, {label(row)}"
    if uris.get("ours") and uris.get("reference"):
        both = image(uris["reference"], f"reference: {what}", "reference") + image(uris["ours"], f"ours: {what}", "ours")
        share = page.text(f"Share of the picture that shows ours: {what}")
        return (f'{HEAD}><div><div class="stage">{both}<span class="left">ours</span><span class="right">reference</span></div>'
                f'<input type="range" min="0" max="100" value="50" aria-label="{share}">{numbers(row)}</div>{beside(uris)}</div>')
    whole = embedded(folder / row["picture"]) if row.get("picture") else None
    return f'{HEAD}><div class="whole">{image(whole, what)}{numbers(row)}</div></div>' if whole else None


def label(row):
    if "method" in row["settings"]:
        return f"{row['quantity']}: {row['settings']['method']}"
    return f"{row['quantity']}, against {rows.reference_of(row)}"


def viewer(title, listed, folder):
    """All comparisons of one scene and camera, the first shown; "" where none has a picture."""
    several = len({row["run"] for row in listed}) > 1
    tried = [(label(row) + (f", run {row['run'] + 1}" if several else ""), choice(row, folder)) for row in listed]
    found = [(name, shown) for name, shown in tried if shown]
    if not found:
        return ""
    options = "".join(f"<option>{page.text(name)}</option>" for name, _ in found)
    select = (f'<label>showing <select aria-label="{page.text(f"Comparison of {title}")}">{options}</select></label>'
              if len(found) > 1 else f'<span class="note">{page.text(found[0][0])}</span>')
    later = [f'{shown[:len(HEAD)]} hidden{shown[len(HEAD):]}' for _, shown in found[1:]]
    return f'<div class="viewer"><h3>{page.text(title)}</h3>{select}\n' + "\n".join([found[0][1], *later]) + "\n</div>"
