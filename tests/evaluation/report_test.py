#!/usr/bin/python3
"""Tests of the report. usage: tests/evaluation/report_test.py"""

import base64
import contextlib
import copy
import hashlib
import html.parser
import importlib.machinery
import importlib.util
import io
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
import xml.dom.minidom

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import numpy as np  # noqa: E402
import PIL.Image  # noqa: E402

import pictures  # noqa: E402
import results  # noqa: E402
from reporting import front, kinds, load  # noqa: E402

loader = importlib.machinery.SourceFileLoader("report", str(HERE / "report"))
command = importlib.util.module_from_spec(importlib.util.spec_from_loader("report", loader))
loader.exec_module(command)

HOSTILE = "<script>alert(1)</script>\"'><img src=x onerror=alert(2)> $\\frac{1$ _x \x01 \ud800 https://example.org/"


def frame_row(case, flags="", error=0.1, seconds=1.0, against="all"):
    values = {"pixels": 5000, "raw_l2": 0.8 * error, "nrmse": error, "nrmse_of_reference": 0.02, "log_ratio_p95": 0.2, "hdr_flip": 0.05,
              "hdr_flip_of_reference": 0.004, "share_over_10_percent": 0.1, "frame_seconds": seconds}
    return {"case": case, "camera": "default", "quantity": "pixels", "against": against, "size": [8, 4],
            "settings": {"flags": flags, "quality": "QUALITY_FAST", "expected_error": 0.01}, "values": values}


def points_row(case, error=0.05):
    return {"case": case, "camera": "default", "quantity": "irradiance", "against": "all", "settings": {"flags": ""},
            "values": {"raw_l2": error, "nrmse": 1.25 * error, "nrmse_of_reference": 0.01, "points_outside_the_grid": 0}}


def edge_row(case, samples):
    return {"case": case, "camera": "default", "quantity": "edges", "against": f"{samples} of 64",
            "settings": {"flags": "--bounces 0", "samples": samples},
            "values": {"hdr_flip": 0.02 / samples, "frame_seconds": 0.1 * samples}}


def bench_row(coding, size):
    return {"case": "windows", "quantity": "coding", "settings": {"coding": coding, "zstd": True},
            "values": {"payload_bytes": size, "encode_ms": 2.5, "added_l2": 0.001}}


def document(rows, bench="evaluation", skipped=()):
    return {"schema": results.SCHEMA, "bench": bench, "date": "2026-01-02T03:04:05+00:00", "commit": "a" * 40,
            "machine": {"system": "Linux", "architecture": "x86_64", "processor": "one", "cores": 2},
            "device": {"choice": "software", "driver": "some driver"}, "rows": list(rows), "skipped": list(skipped)}


ROWS = (frame_row("room"), points_row("room"), frame_row("box", error=0.3), edge_row("room", 1), edge_row("room", 8))


class Page(html.parser.HTMLParser):
    """Elements as (tag, attributes), and the sortable tables as lists of rows of cells: (tag, attributes, tags inside)."""

    def __init__(self, text):
        super().__init__()
        self.elements, self.tables, self.words, self.cell = [], [], [], None
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.elements.append((tag, attributes))
        if tag == "table" and "sortable" in attributes.get("class", ""):
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self.cell = (tag, attributes, [])
            self.tables[-1][-1].append(self.cell)
        elif self.cell:
            self.cell[2].append(tag)

    def handle_endtag(self, tag):
        if tag in ("td", "th"):
            self.cell = None

    def handle_data(self, data):
        if self.elements and self.elements[-1][0] not in ("style", "script"):
            self.words.append(data)

    def of(self, tag):
        return [attributes for name, attributes in self.elements if name == tag]


class Made(unittest.TestCase):
    """A folder for results and reports."""

    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)

    def write(self, name, content):
        folder = self.folder / name
        folder.mkdir(exist_ok=True)
        (folder / "results.json").write_text(json.dumps(content))
        return folder

    def run_report(self, *arguments):
        """The exit code; what was said goes into `printed` and `complaint`."""
        said, complained = io.StringIO(), io.StringIO()
        with unittest.mock.patch.object(sys, "argv", ["report", *map(str, arguments)]), contextlib.redirect_stdout(said), \
                contextlib.redirect_stderr(complained):
            try:
                code = command.main()
            except SystemExit as end:
                code = end.code
        self.printed, self.complaint = said.getvalue(), complained.getvalue()
        return code

    def report(self, *folders, against=None, expected=0, output="out"):
        arguments = ["--results", *folders, "--output", self.folder / output, *(["--against", against] if against else [])]
        self.assertEqual(self.run_report(*arguments), expected, self.complaint)
        self.text = (self.folder / output / "report.html").read_text()
        return Page(self.text)

    def images(self, folder, size=(8, 4)):
        """Pictures of a row, for its `images`."""
        for i, name in enumerate(("ours", "reference", "difference", "flip")):
            PIL.Image.new("RGB", size, (40 * i, 90, 200)).save(folder / f"{name}.png")
        return {name: f"{name}.png" for name in ("ours", "reference", "difference", "flip")}


class Whole(Made):
    def with_pictures(self):
        row = frame_row("room")
        folder = self.write("a", document([]))
        row["images"] = self.images(folder)
        return self.write("a", document([row, *ROWS[1:]], skipped=[{"case": "hall", "reason": "its file is not there"}]))

    # Broken by: a picture's path instead of its data; a namespace left in a figure; a font from elsewhere.
    def test_the_page_asks_for_nothing(self):
        page = self.report(self.with_pictures(), self.write("b", document([bench_row("half", 10), bench_row("compact", 5)], "codec")))
        self.assertNotRegex(self.text, "https?:|//[a-z]+\\.|@import|url\\((?!#)")
        self.assertEqual([tag for tag, _ in page.elements if tag in ("link", "iframe", "object", "embed", "base", "form")], [])
        for tag, attributes in page.elements:
            self.assertTrue(attributes.get("src", "data:image/webp;base64,").startswith("data:image/webp;base64,"), attributes.get("src"))
            self.assertTrue(attributes.get("href", "#").startswith("#"), attributes.get("href"))
            self.assertNotIn("srcset", attributes)
        self.assertEqual(len(page.of("img")), 4)
        self.assertGreaterEqual(len(page.of("svg")), 3)
        ids = [attributes["id"] for _, attributes in page.elements if "id" in attributes]
        self.assertEqual(len(ids), len(set(ids)))

    # Broken by: the policy's hash of another text than the script's, so that the script would not run.
    def test_the_policy_lets_the_script_run_and_nothing_else(self):
        page = self.report(self.with_pictures())
        policy = next(meta["content"] for meta in page.of("meta") if "http-equiv" in meta)
        script = self.text[self.text.index("<script>") + 8:self.text.index("</script>")]
        self.assertIn(f"script-src 'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'", policy)
        self.assertIn("default-src 'none'", policy)
        self.assertEqual([a for _, a in page.elements if any(name.startswith("on") for name in a)], [])

    # Broken by: a header without its button; a cell without data-value; a row shorter than the header.
    def test_tables_can_be_sorted_by_their_headers(self):
        page = self.report(self.with_pictures(), self.write("b", document([bench_row("half", 10), bench_row("compact", 5)], "codec")))
        self.assertGreaterEqual(len(page.tables), 6)
        for head, *body in page.tables:
            for tag, attributes, inside in head:
                self.assertEqual((tag, attributes["scope"], attributes["aria-sort"], inside), ("th", "col", "none", ["button"]))
            self.assertTrue(body)
            for row in body:
                self.assertEqual(len(row), len(head))
                for _, attributes, _ in row:
                    self.assertIn("data-value", attributes)
                    if "number" in attributes.get("class", ""):
                        self.assertRegex(attributes["data-value"], r"^(-?\d[\d.e+-]*)?$")

    # Broken by: the date of the report in it; ids of figures that are random; sets whose order is not.
    def test_the_same_results_make_the_same_bytes(self):
        source = self.with_pictures()
        for name, seed in (("one", "1"), ("two", "2")):
            subprocess.run([HERE / "report", "--results", source, "--output", self.folder / name], check=True, capture_output=True,
                           env={**os.environ, "PYTHONHASHSEED": seed, "TZ": f"UTC{seed}"})
        one, two = ({str(p.relative_to(self.folder / name)): p.read_bytes() for p in (self.folder / name).rglob("*") if p.is_file()}
                    for name in ("one", "two"))
        self.assertLessEqual({"report.html", "results.json", "results.csv", "figures/edges.svg"}, set(one))
        self.assertEqual(one, two)

    # Broken by: any text that is not escaped, in the page or in a figure.
    def test_names_that_are_markup_are_text(self):
        bench = {"case": HOSTILE, "quantity": "../" + HOSTILE, "settings": {HOSTILE: HOSTILE},
                 "values": {HOSTILE: 1.0, "tick_seconds": 1.0, "raw_l2": 0.5}}
        rows = [frame_row(HOSTILE, HOSTILE), frame_row(HOSTILE, "other", 0.2), edge_row(HOSTILE, 1), bench]
        rows[0]["images"] = self.images(self.write("a", document([])))
        content = document(rows, HOSTILE, [{"case": HOSTILE, "reason": HOSTILE}])
        content["device"]["driver"] = content["machine"]["processor"] = content["commit"] = HOSTILE
        page = self.report(self.write("a", content), against=self.write("old", document([frame_row(HOSTILE, HOSTILE, 0.01)])), expected=1)
        self.assertEqual(len(page.of("script")), 1)
        self.assertEqual(len(page.of("img")), 4)
        self.assertNotIn("onerror", "".join(name for _, attributes in page.elements for name in attributes))
        self.assertIn("<script>alert(1)</script>", "".join(page.words))
        self.assertTrue(all("/" not in path.name for path in (self.folder / "out/figures").iterdir()))
        self.assertEqual({path.name for path in self.folder.iterdir()}, {"a", "old", "out"})
        for figure in (self.folder / "out/figures").iterdir():
            xml.dom.minidom.parse(str(figure))

    def test_what_is_not_measured_is_said_in_a_sentence(self):
        page = self.report(self.write("a", document([])))
        self.assertEqual(page.tables, [])
        words = " ".join(page.words)
        for said in ("Frames and irradiance are not measured", "Edges are not measured", "No bench's results were given",
                     "There are no pictures", "time against error is not measured", "Nothing that was asked for was skipped"):
            self.assertIn(said, words)
        page = self.report(self.with_pictures())
        self.assertIn("its file is not there", page.words)

    # Broken by: the noise left out.
    def test_figures_stand_beside_the_noise_of_the_reference(self):
        page = self.report(self.write("a", document(ROWS)))
        self.assertIn('data-value="0.1">10&nbsp;<small>2</small>', self.text)  # NRMSE of a frame
        self.assertIn('data-value="0.05">5&nbsp;<small>0.8</small>', self.text)  # raw L2 of E: .01 * .05 / .0625
        self.assertIn('data-value="0.05">0.05&nbsp;<small>0.004</small>', self.text)  # FLIP
        self.assertIn("some driver", page.words)

    # Broken by: every row of irradiance in the summary, where the formulas' have nothing to show; their own table left out.
    def test_formulas_have_a_table_of_their_own(self):
        row = {"case": "5.9 4 x 4", "quantity": "irradiance", "settings": {"asked": "GATHER 64", "reflectance": 0.0, "bounces": 0},
               "values": {"points": 14, "formula": 29.6, "ours": 29.1, "relative_rms": 0.013, "relative_worst": 0.027}}
        self.report(self.write("a", document([*ROWS, row])))
        sections = {part.split('"', 1)[0]: part for part in self.text.split('<section id="')[1:]}
        self.assertNotIn("5.9 4 x 4", sections["summary"])
        self.assertIn('data-value="0.013">1.3</td>', sections["analytic"])

    # Broken by: what all runs have said once for each; a renderer and all that a driver says of it taken for two.
    def test_what_all_runs_have_is_said_once(self):
        told = [document(ROWS, "one"), document(ROWS, "two"), document(ROWS, "three")]
        for content, driver in zip(told, ("llvmpipe (LLVM 15)", "OpenGL 4.5 Mesa 22 on llvmpipe (LLVM 15) (Mesa/X.org)", "no device: in double, on the CPU")):
            content["device"]["driver"] = driver
        page = self.report(*(self.write(content["bench"], content) for content in told))
        self.assertNotIn("their times cannot be compared", " ".join(page.words))
        self.assertEqual(self.text.count("<dt>machine</dt>"), 1)
        told[1]["device"]["driver"] = "another"
        page = self.report(*(self.write(content["bench"], content) for content in told))
        self.assertIn("their times cannot be compared", " ".join(page.words))

    # Broken by: no slider where there are two pictures; rows of runs without single pictures left out.
    def test_pictures_have_a_slider_and_scales(self):
        page = self.report(self.with_pictures())
        self.assertEqual([a["type"] for a in page.of("input")], ["range"])
        self.assertEqual(sum(a.get("class") == "bar" for a in page.of("div")), 2)
        self.assertIn("+100 %", page.words)
        folder = self.write("b", document([]))
        PIL.Image.new("RGB", (2000, 100)).save(folder / "whole.png")
        page = self.report(self.write("b", document([{**frame_row("room"), "picture": "whole.png"}])), output="whole")
        self.assertEqual((len(page.of("img")), len(page.of("input"))), (1, 0))
        self.assertIn("have no slider", self.text)
        page = self.report(self.write("c", document([{**frame_row("room"), "picture": "gone.png"}])), output="gone")
        self.assertIn("are not where they say", self.text)

    def test_joined_results_are_as_the_schema_says_and_can_be_read_again(self):
        first, second = self.with_pictures(), self.write("b", document([bench_row("half", 10)], "codec"))
        self.report(first, second)
        joined = json.loads((self.folder / "out/results.json").read_text())
        self.assertEqual(results.check(joined), [])
        self.assertEqual([row["run"] for row in joined["rows"]], [0] * 5 + [1])
        self.assertEqual([run["bench"] for run in joined["runs"]], ["evaluation", "codec"])
        page = self.report(self.folder / "out", output="again")
        self.assertEqual(json.loads((self.folder / "again/results.json").read_text())["runs"], joined["runs"])
        self.assertEqual(len(page.of("img")), 4)


class Measures(Made):
    @staticmethod
    def row(case, quantity, settings, **values):
        return {"case": case, "quantity": quantity, "settings": settings, "values": values}

    # Broken by: the paper's columns in another order; ratios the other way round.
    def test_ratios_stand_beside_the_papers(self):
        times = {"dense 1": 2.0, "dense 100": 50.0, "dense 1000": 600.0, "COUNT": 5.0, "FLUX": 8.0}
        self.report(self.write("a", document([self.row("Lucy", "injection", {"grid": 64, "method": method}, wall_ms=ms)
                                              for method, ms in times.items()], "paper")))
        for here, theirs in (("0.4x", "0.4x"), ("10.0x", "30.4x"), ("120.0x", "301.8x")):
            self.assertRegex(self.text, f">{here}</td><td[^>]*>{theirs}<")

    # Broken by: an exponent of values that are not logarithms; a step that is named where it ends.
    def test_growth_is_told_by_exponents(self):
        rows = [self.row(name, "scale", {"count": count}, tick_ms=ms(count)) for name, ms in
                (("even", lambda n: 3.0), ("straight", lambda n: 2.0 * n), ("steep", lambda n: n if n < 20 else n * n / 16))
                for count in (1, 4, 16, 64)]
        page = self.report(self.write("a", document(rows, "scale")))
        told = {row[0][1]["data-value"]: row for table in page.tables for row in table[1:] if row[0][1]["data-value"] in ("even", "straight", "steep")
                and len(row) == 8}
        self.assertAlmostEqual(float(told["even"][6][1]["data-value"]), 0.0)
        self.assertAlmostEqual(float(told["straight"][6][1]["data-value"]), 1.0)
        self.assertIn("nowhere", told["straight"][7][1]["data-value"])
        self.assertIn("from 16, where it grows by an exponent of 2.00", told["steep"][7][1]["data-value"])
        self.assertTrue((self.folder / "out/figures/scale-time.svg").exists())

    def test_codings_have_a_front(self):
        rows = [self.row("moving", "coding", {"coding": name}, bytes=size, irradiance_l2=error)
                for name, size, error in (("half", 1e6, 1e-4), ("compact", 1e5, 2e-3), ("zfp", 3e5, 3e-3))]
        self.report(self.write("a", document(rows, "coding")))
        self.assertTrue((self.folder / "out/figures/coding.svg").exists())

    # Broken by: a section that takes a row for one of its own by the quantity alone.
    def test_rows_of_the_same_quantity_without_what_is_needed_are_left_out(self):
        rows = [self.row("a", quantity, {}, tick_ms=1.0) for quantity in ("injection", "coding", "scale", "transport", "paper's pictures",
                                                                          "power", "flicker", "features")]
        self.report(self.write("a", document(rows, "other")))


class Against(Made):
    def judged(self, change, expected):
        """The report of ROWS after `change(rows)` against ROWS."""
        rows = copy.deepcopy([*ROWS, bench_row("half", 1000)])
        old = self.write("old", document(rows))
        rows = copy.deepcopy(rows)
        change(rows)
        page = self.report(self.write("new", document(rows)), against=old / "results.json", expected=expected)
        return " ".join(page.words)

    def test_an_unchanged_file_names_nothing(self):
        words = self.judged(lambda rows: None, 0)
        self.assertIn("Nothing became worse", words)
        self.assertNotIn("WORSE", self.printed)

    # Broken by: errors compared with those of another scene; the exit code 0.
    def test_an_error_that_grew_is_named(self):
        def change(rows):
            rows[2]["values"]["nrmse"] *= 1.2
        words = self.judged(change, 1)
        self.assertRegex(self.printed, "WORSE: box, default, pixels against all: NRMSE was 0.3, is 0.36")
        self.assertEqual(self.printed.count("WORSE"), 1)
        self.assertIn("1 became worse", words)
        self.assertLess(self.text.index('id="change"'), self.text.index('id="summary"'))

    # Broken by: 1 % of the value alone, noise or not.
    def test_an_error_that_grew_by_less_than_the_noise_is_not(self):
        def change(rows):
            rows[0]["values"]["nrmse"] += 0.019
        self.judged(change, 0)

    # Broken by: noise allowed to figures that have none.
    def test_bytes_and_counts_and_lost_numbers_are_judged(self):
        for index, name, value in ((5, "payload_bytes", 1011), (1, "points_outside_the_grid", 1), (0, "nrmse", None),
                                   (4, "hdr_flip", 0.00253)):
            self.judged(lambda rows: rows[index]["values"].update({name: value}), 1)
            self.assertEqual(self.printed.count("WORSE"), 1, name)
        self.judged(lambda rows: rows[5]["values"].update(payload_bytes=1010), 0)

    def test_times_are_shown_and_not_judged(self):
        def change(rows):
            for row in rows:
                row["values"].update({name: 9.0 for name in row["values"] if kinds.kind(name) == "time"})
        words = self.judged(change, 0)
        self.assertIn("5 times, not judged", words)
        self.assertIn("Nothing became worse", words)

    # Broken by: rows matched by all their settings, so that a default that makes things worse is another row.
    def test_a_new_default_is_judged(self):
        def change(rows):
            rows[0]["settings"]["quality"] = "QUALITY_WORSE"
            rows[0]["values"]["nrmse"] = 0.5
        words = self.judged(change, 1)
        self.assertIn("quality was FAST, is WORSE", words)

    def test_measurements_that_are_gone_are_said(self):
        words = self.judged(lambda rows: rows.pop(2), 0)
        self.assertIn("1 measurements of the earlier run are not in this one", words)
        self.assertIn("box, default, pixels", words)


class Usage(Made):
    def refused(self, *arguments):
        self.assertEqual(self.run_report(*arguments), 2, self.printed)
        return self.complaint

    def test_wrong_files_are_named(self):
        good = self.write("a", document(ROWS))
        self.assertIn("nowhere", self.refused("--results", self.folder / "nowhere"))
        self.assertIn("is no JSON object", self.refused("--results", self.write("b", [1])))
        self.assertIn("schema is 7, and 1", self.refused("--results", self.write("c", {**document([]), "schema": 7})))
        self.assertIn("rows[0].camera is no str", self.refused("--results", self.write("d", document([{**ROWS[0], "camera": 3}]))))
        self.assertIn("rows is missing", self.refused("--results", self.write("e", {**document([]), "rows": 3})))
        self.assertIn("values is missing", self.refused("--results", self.write("f", document([{**ROWS[0], "values": [1]}]))))
        self.assertIn("nowhere", self.refused("--results", good, "--against", self.folder / "nowhere"))

    # Broken by: results written over by those that were made of them.
    def test_results_are_not_written_over(self):
        good = self.write("a", document(ROWS))
        before = (good / "results.json").read_bytes()
        self.assertIn("written over", self.refused("--results", good, "--output", good))
        self.assertEqual((good / "results.json").read_bytes(), before)


class Parts(unittest.TestCase):
    # Broken by: points that are as good in one and worse in the other kept on the front.
    def test_the_front_is_what_no_point_beats(self):
        points = [front.Point("a", str(i), seconds, error, False) for i, (seconds, error) in
                  enumerate([(1, 5), (2, 3), (2, 4), (3, 3), (4, 1), (5, 2)])]
        self.assertEqual([p.best for p in front.marked(points)], [True, True, False, False, True, False])

    # Broken by: means over scenes that only some configurations were measured in.
    def test_means_are_of_configurations_measured_everywhere(self):
        listed = [frame_row("a", "x", 0.1, 1.0), frame_row("b", "x", 0.4, 4.0), frame_row("a", "y", 0.2, 0.5)]
        group, = front.groups(load.joined([(document(listed), pathlib.Path("."))], pathlib.Path("out")))
        self.assertEqual([p.configuration for p in group.overall], ["x"])
        self.assertAlmostEqual(group.overall[0].seconds, 2.0)
        self.assertAlmostEqual(group.overall[0].error, 0.2)

    def test_names_tell_what_is_judged(self):
        kind = {name: kinds.kind(name) for name in ("raw_l2", "nrmse_shadowed", "hdr_flip", "log_ratio_p95", "payload_bytes", "vpl_count",
                                                    "worst_error", "encode_ms", "frame_seconds", "nrmse_of_reference", "nrmse_se",
                                                    "mean_ours", "pixels")}
        self.assertEqual(list(kind.values()), ["error"] * 4 + ["bytes", "count", "error", "time", "time"] + [None] * 4)

    # Broken by: names that the report judges missing from the schema.
    def test_the_schema_says_what_names_tell(self):
        text = (HERE / "results.schema.md").read_text()
        for word in (*kinds.ERRORS, *kinds.NAMED, *front.TIMES, *front.ERRORS):
            self.assertIn(f"`{word}`", text)
        for ending in (*(f"_{unit}" for unit in kinds.TIMES), kinds.NOISE, kinds.SPREAD, "_count"):
            self.assertIn(f"`{ending}`", text)

    # Broken by: a picture of another size than the frame; nan in the colours of the scale.
    def test_single_pictures_have_a_pixel_for_each_of_the_frame(self):
        truth = np.ones((4, 8, 3))
        ours = truth * np.array([0.0, 1, 2, 9, 1, 1, 1, 1])[:, None]
        surface = np.ones((4, 8), bool)
        surface[:, 7] = False
        with tempfile.TemporaryDirectory() as folder:
            paths = pictures.separate(pathlib.Path(folder) / "a", ours, truth, surface, np.zeros((4, 8)))
            self.assertEqual(set(paths), {"ours", "reference", "difference", "flip"})
            shown = np.asarray(PIL.Image.open(paths["difference"]).convert("RGB"))
            self.assertEqual(shown.shape, (4, 8, 3))
            blue, even, red, redder, grey = shown[0, [0, 1, 2, 3, 7]].astype(int)
            self.assertGreater(blue[2], blue[0] + 50)
            self.assertLess(np.ptp(even), 4)
            self.assertGreater(red[0], red[2] + 50)
            self.assertEqual(list(red), list(redder))
            self.assertEqual(list(grey), [153] * 3)
            with PIL.Image.open(paths["ours"]) as ours:
                self.assertEqual(ours.size, (8, 4))


if __name__ == "__main__":
    unittest.main()
