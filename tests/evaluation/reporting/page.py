"""Pieces of the HTML page. Every text of a result goes through `text`."""

import base64
import hashlib
import html
import pathlib

HERE = pathlib.Path(__file__).resolve().parent
NOTHING = "–"
MANY = 13  # columns, above which a table has smaller letters


def text(value):
    return html.escape(str(value), quote=True)


def number(value):
    """Three significant digits, without an exponent where a person would not write one."""
    if value is None:
        return NOTHING
    if isinstance(value, bool) or value == int(value) and abs(value) < 1e7:
        return str(int(value))
    if not 1e-4 <= abs(value) < 1e6:
        return f"{value:.2e}"
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def percent(value):
    """Two significant digits of a share, in percent."""
    if value is None:
        return NOTHING
    value *= 100
    return "0" if value == 0 else f"{value:.1e}" if abs(value) < 0.001 else f"{value:.0f}" if abs(value) >= 99.5 else f"{value:.2g}"


def short(value):
    """Two significant digits."""
    return number(value) if value is None or value == 0 else f"{value:.1e}" if abs(value) < 1e-4 else f"{value:.2g}"


def words(value, row_head=False):
    """A cell of text; by it the row is known if it is its head."""
    shown = text(value) if str(value) else NOTHING
    return f'<th scope="row" data-value="{text(value)}">{shown}</th>' if row_head else f'<td data-value="{text(value)}">{shown}</td>'


def figure_cell(value, shown=number, noise=None, near=False):
    """A cell of a number, with the reference's noise in small print. `near`: the figure is hardly above it."""
    beside = f'&nbsp;<small>{shown(noise)}</small>' if noise is not None else ""
    kind = "number near" if near else "number"
    return f'<td class="{kind}" data-value="{"" if value is None else repr(float(value))}">{shown(value)}{beside}</td>'


def table(caption, columns, lines):
    """A table that sorts by a click on a header: `columns` are titles, `lines` lists of cells."""
    heads = "".join(f'<th scope="col" aria-sort="none" data-title="{text(title)}"><button type="button">{text(title)}</button></th>'
                    for title in columns)
    body = "\n".join(f"<tr>{''.join(line)}</tr>" for line in lines)
    kind = "sortable many" if len(columns) > MANY else "sortable"
    return (f'<div class="wide"><table class="{kind}"><caption>{text(caption)}</caption>\n<thead><tr>{heads}</tr></thead>\n'
            f"<tbody>\n{body}\n</tbody></table></div>")


def paragraph(*sentences):
    return f"<p>{text(' '.join(sentences))}</p>"


def bullets(sentences):
    return f"<ul>{''.join(f'<li>{text(sentence)}</li>' for sentence in sentences)}</ul>"


def folded(title, content):
    return f"<details><summary>{text(title)}</summary>\n{content}\n</details>"


def section(name, title, *content):
    return f'<section id="{name}"><h2>{text(title)}</h2>\n' + "\n".join(content) + "\n</section>"


def drawing(svg, caption):
    return f'<figure class="drawing" role="img" aria-label="{text(caption)}">{svg}<figcaption>{text(caption)}</figcaption></figure>'


def page(title, head, sections):
    """The whole document. Its policy lets it run its own script and nothing else, and load nothing."""
    style, script = ((HERE / name).read_text() for name in ("page.css", "page.js"))
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = f"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'sha256-{digest}'"
    links = "".join(f'<a href="#{name}">{text(name)}</a>' for name, _ in sections)
    return (f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
            f'<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f"<title>{text(title)}</title>\n<style>\n{style}</style>\n</head>\n<body>\n<header><h1>{text(title)}</h1>\n{head}\n"
            f"<nav>{links}</nav></header>\n<main>\n" + "\n".join(content for _, content in sections) +
            f"\n</main>\n<script>{script}</script>\n</body>\n</html>\n")
