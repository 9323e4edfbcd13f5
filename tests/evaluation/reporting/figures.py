"""Figures as SVG. The same numbers give the same bytes: no date, no random names. Text and axes have the colour of the
text around them, so that they can be read on light and dark pages."""

import io
import logging
import math
import re
import warnings

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

INK = "#010203"  # stands for the colour of the text until the file is written
COLOURS = ("#3d8fd1", "#e0703a", "#2fa87c", "#b678c4", "#c9992e", "#d1587e", "#5fa5a8", "#8a8f98")
MARKERS = "osD^vP*X"
STYLE = {"svg.fonttype": "none", "font.family": "sans-serif", "font.sans-serif": ["DejaVu Sans"], "font.size": 9,
         "text.parse_math": False, "text.color": INK, "axes.edgecolor": INK, "axes.labelcolor": INK, "xtick.color": INK,
         "ytick.color": INK, "axes.facecolor": "none", "figure.facecolor": "none", "savefig.facecolor": "none",
         "legend.framealpha": 0.0, "legend.edgecolor": "none", "axes.grid": True, "grid.color": "#888888",
         "grid.alpha": 0.25, "axes.spines.top": False, "axes.spines.right": False}
OTHERS = {"color": "#8a8f98", "marker": ".", "alpha": 0.6}  # configurations without a name in the figure
PANELS, MOST_TICKS, LONGEST = 3, 6, 40
WIDTH = 12.4  # inches: what a page of 1280 pixels has room for
METADATA = {key: None for key in ("Creator", "Date", "Format", "Type")}


def drawn(name, draw, size):
    """The SVG that `draw(figure)` makes; its ids begin with the name, so that several can stand in one page."""
    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)
    with plt.rc_context({**STYLE, "svg.hashsalt": name}), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph")
        figure = plt.figure(figsize=size, constrained_layout=True)
        draw(figure)
        out = io.StringIO()
        figure.savefig(out, format="svg", metadata=METADATA)
        plt.close(figure)
    text = re.sub(r'((?: id="|xlink:href="#|url\(#))', rf"\g<1>{name}-", out.getvalue())
    return text.replace(INK, "currentColor")


def inline(svg):
    """The SVG as part of an HTML page: without prologue and namespaces."""
    svg = svg[svg.index("<svg"):]
    svg = re.sub(r'\s(?:xmlns(?::\w+)?|version)="[^"]*"', "", svg.replace("xlink:href", "href"))
    return re.sub(r"<metadata>.*?</metadata>\s*", "", svg, flags=re.S)


def style_of(i):
    return {"color": COLOURS[i % len(COLOURS)], "marker": MARKERS[i // len(COLOURS) % len(MARKERS)]}


def ticks_between(low, high):
    """Plain numbers for a logarithmic axis: as many as fit."""
    finest = (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8)
    for steps in (finest, (1, 1.5, 2, 3, 5, 7), (1, 2, 5), (1, 3), (1,)):
        decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
        found = [step * 10.0 ** decade for decade in decades for step in steps if low <= step * 10.0 ** decade <= high]
        if len(found) <= MOST_TICKS:
            break
    return found


def logarithmic(axis, xs, ys):
    """Both axes logarithmic, with room around the points and plain numbers."""
    for set_scale, set_limits, ticks, values in ((axis.set_xscale, axis.set_xlim, axis.xaxis, xs),
                                                 (axis.set_yscale, axis.set_ylim, axis.yaxis, ys)):
        set_scale("log")
        low, high = min(values), max(values)
        room = max(1.25, (high / low) ** 0.08)
        set_limits(low / room, high * room)
        ticks.set_major_locator(matplotlib.ticker.FixedLocator(ticks_between(low / room, high * room)))
        ticks.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda v, _: f"{v:.3g}" if v < 1000 else f"{v:.0f}"))
        ticks.set_minor_locator(matplotlib.ticker.NullLocator())


def spread(axis, points):
    logarithmic(axis, [p.seconds for p in points], [p.error for p in points])


def panels(figure, rows=1, columns=1):
    """Axes row by row, and one at their right for the legend."""
    grid = figure.add_gridspec(rows, columns + 1, width_ratios=[8.6 / columns] * columns + [3.4])
    key = figure.add_subplot(grid[:, columns])
    key.set_axis_off()
    return [figure.add_subplot(grid[row, column]) for row in range(rows) for column in range(columns)], key


def legend(axis, named):
    """The names of styles: (label, style), cut where they are too long."""
    handles = [plt.Line2D([], [], linestyle="none", **style) for _, style in named]
    labels = [label if len(label) <= LONGEST else f"{label[:LONGEST - 1]}…" for label, _ in named]
    axis.legend(handles, labels, fontsize=8, loc="center left", bbox_to_anchor=(0, 0.5)).set_in_layout(False)


def styles_of(group):
    """The style of each configuration that has a name in the figures; see Group.named."""
    return {name: style_of(i) for i, name in enumerate(group.named)}


def with_others(styles, group):
    rest = len(group.configurations) - len(styles)
    return [*styles.items(), *([(f"{rest} others", OTHERS)] if rest else [])]


def front(axis, points):
    """The points that nothing beats, ringed and joined by steps."""
    best = sorted((p.seconds, p.error) for p in points if p.best)
    axis.step(*zip(*best), where="post", color=INK, linewidth=0.9, linestyle=":", zorder=1)
    axis.plot(*zip(*best), linestyle="none", marker="o", markersize=10, markerfacecolor="none", markeredgecolor=INK,
              markeredgewidth=0.9, zorder=4)


def points_of(axis, points, styles):
    """Points by the styles of their names; those without one are small and grey, below the rest."""
    for point, style in zip(points, styles):
        axis.plot(point.seconds, point.error, linestyle="none", markersize=5.5, zorder=2 if style is OTHERS else 3, **style)


def named_axes(axis, group):
    axis.set_xlabel("time, s")
    axis.set_ylabel(group.error_title)


def by_configuration(axis, points, styles):
    spread(axis, points)
    front(axis, points)
    points_of(axis, points, [styles.get(point.configuration, OTHERS) for point in points])


def per_scene(group):
    """A panel for each scene with its configurations and the front."""
    rows = math.ceil(len(group.places) / PANELS)

    def draw(figure):
        styles = styles_of(group)
        axes, key = panels(figure, rows, PANELS)
        for axis, (place, points) in zip(axes, group.places.items()):
            by_configuration(axis, points, styles)
            axis.set_title(place, fontsize=9)
            named_axes(axis, group)
        for axis in axes[len(group.places):]:
            axis.set_axis_off()
        legend(key, with_others(styles, group))
    return drawn(f"{group.name}-scenes", draw, (WIDTH, 2.5 * rows))


def overall(group):
    """Configurations by their means over the scenes, and the front."""
    def draw(figure):
        styles = styles_of(group)
        (axis,), key = panels(figure)
        by_configuration(axis, group.overall, styles)
        named_axes(axis, group)
        legend(key, with_others(styles, group))
    return drawn(f"{group.name}-overall", draw, (WIDTH, 4.2))


def scenes(group):
    """Scenes of one configuration: where they lie, without a front, since none of them stands in for another."""
    points = [point for found in group.places.values() for point in found]
    styles = [style_of(i) for i in range(len(points))]

    def draw(figure):
        (axis,), key = panels(figure)
        spread(axis, points)
        points_of(axis, points, styles)
        named_axes(axis, group)
        legend(key, [(point.place, style) for point, style in zip(points, styles)])
    return drawn(group.name, draw, (WIDTH, 4.2))


def fronts(name, points, x_title, y_title):
    """Points of one place by their configurations, and the front; an axis may be something else than a time."""
    styles = [style_of(i) for i in range(len(points))]

    def draw(figure):
        (axis,), key = panels(figure)
        spread(axis, points)
        front(axis, points)
        points_of(axis, points, styles)
        axis.set_xlabel(x_title)
        axis.set_ylabel(y_title)
        legend(key, [(point.configuration, style) for point, style in zip(points, styles)])
    return drawn(name, draw, (WIDTH, 4.6))


def growth(name, lines, x_title, y_title):
    """As `curves`, over decades of x."""
    return curves(name, lines, x_title, y_title, every_x=False)


def curves(name, lines, x_title, y_title, every_x=True):
    """A line for each entry of {label: [(x, y)]}, both axes logarithmic, with `every_x` a tick at each x."""
    def draw(figure):
        (axis,), key = panels(figure)
        for i, points in enumerate(lines.values()):
            axis.plot(*zip(*points), linewidth=1.2, markersize=4.5, **style_of(i))
        xs, ys = ([point[i] for points in lines.values() for point in points] for i in (0, 1))
        logarithmic(axis, xs, ys)
        if every_x:
            axis.xaxis.set_major_locator(matplotlib.ticker.FixedLocator(sorted(set(xs))))
        axis.set_xlabel(x_title)
        axis.set_ylabel(y_title)
        legend(key, [(label, style_of(i)) for i, label in enumerate(lines)])
    return drawn(name, draw, (WIDTH, 4.0))
