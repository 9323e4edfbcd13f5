"""Time against error: points of rows that have both, and which of them no other is better than in both."""

import collections
import math
import re

from reporting import kinds, rows

TIMES = ("served_seconds", "tick_seconds", "frame_seconds")
ERROR_OF = {"pixels": "nrmse", "edges": "hdr_flip"}
ERRORS = ("raw_l2", "nrmse", "hdr_flip")
MOST_NAMED = 16

Point = collections.namedtuple("Point", "place configuration seconds error best")


def names_of(row):
    """(time's name, error's name) of a row that has both, or None."""
    values = row["values"]
    wanted = (ERROR_OF[row["quantity"]],) if row["quantity"] in ERROR_OF else ERRORS
    time, error = (next((name for name in names if values.get(name) is not None), None) for names in (TIMES, wanted))
    return (time, error) if time and error else None


def positive(row):
    """Whether the row can be a point: axes are logarithmic."""
    return all(row["values"][name] > 0 for name in names_of(row))


def marked(points):
    """The points with `best` set: those for which no other is as fast and as exact and better in one."""
    def beaten(p):
        return any(q.seconds <= p.seconds and q.error <= p.error and (q.seconds, q.error) != (p.seconds, p.error)
                   for q in points)
    return [p._replace(best=not beaten(p)) for p in points]


class Group:
    """Points of one quantity: by scene, and over all scenes by configuration."""

    def __init__(self, quantity, listed, run_names, number):
        self.quantity = quantity
        self.zeros = [row for row in listed if not positive(row)]
        listed = [row for row in listed if positive(row)]
        self.name = f"time-{number}-{re.sub('[^A-Za-z0-9]+', '-', quantity)[:40]}"  # of its figures' files
        self.time, self.error = names_of(listed[0])
        self.against = list(dict.fromkeys(map(rows.reference_of, listed))) if quantity == "pixels" else []
        keys = rows.varying(listed)
        runs = {row["run"] for row in listed}
        points = [Point(rows.named(row), self.label(row, keys, runs, run_names), row["values"][self.time],
                        row["values"][self.error], False) for row in listed]
        by_place = collections.defaultdict(list)
        for point in points:
            by_place[point.place].append(point)
        self.places = {place: marked(found) for place, found in by_place.items()}
        self.configurations = list(dict.fromkeys(point.configuration for point in points))
        self.overall = marked(self.means())

    @staticmethod
    def label(row, keys, runs, run_names):
        name = rows.configuration(row, keys)
        return f"{name}, run {run_names[row['run']]}" if len(runs) > 1 else name

    def means(self):
        """Geometric means over the scenes, of configurations that were measured in all of them."""
        out = []
        for name in self.configurations:
            found = [p for points in self.places.values() for p in points if p.configuration == name]
            if len({p.place for p in found}) == len(self.places):
                time, error = (math.exp(sum(map(math.log, values)) / len(found)) for values in
                               ([p.seconds for p in found], [p.error for p in found]))
                out.append(Point("all", name, time, error, False))
        return out

    @property
    def named(self):
        """The configurations that figures name: all, or where they are many those on the front over all scenes (without
        one, of any scene)."""
        if len(self.configurations) <= MOST_NAMED:
            return self.configurations
        points = self.overall or [point for found in self.places.values() for point in found]
        best = sorted((point for point in points if point.best), key=lambda point: point.seconds)
        return list(dict.fromkeys(point.configuration for point in best))[:MOST_NAMED]

    @property
    def error_title(self):
        return kinds.title(self.error)


def groups(content):
    """A Group per quantity whose rows have a time and an error; of the evaluation's frames those with the most bounces."""
    listed = collections.defaultdict(list)
    frames = [row for row in content["rows"] if row["quantity"] == "pixels"]
    others = [row for row in content["rows"] if row["quantity"] not in ("pixels", "irradiance")]
    for row in rows.foremost(frames) + others:
        if names_of(row):
            listed[(row["quantity"], *names_of(row))].append(row)
    run_names = [str(i + 1) for i in range(len(content["runs"]))]
    usable = [(key[0], found) for key, found in listed.items() if any(map(positive, found))]
    return [Group(quantity, found, run_names, i + 1) for i, (quantity, found) in enumerate(usable)]
