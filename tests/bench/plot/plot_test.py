#!/usr/bin/env python3
"""What    kdray-bench-plot on small reports: what is drawn of them, and what is refused."""

import contextlib
import copy
import importlib.machinery
import importlib.util
import io
import json
import math
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
script = pathlib.Path(sys.argv.pop(1))
loader = importlib.machinery.SourceFileLoader("plot", str(script))
plot = importlib.util.module_from_spec(importlib.util.spec_from_loader("plot", loader))
try:
    loader.exec_module(plot)
except SystemExit as missing:
    sys.exit(77 if missing.code == 3 else missing.code)  # no matplotlib: the test is skipped


def spread(median):
    return {"median": median, "min": 0.9 * median, "max": 1.1 * median}


def frame(scene, rate):
    return {
        "scene": scene,
        "device": "a device",
        "rays": {"total": 2e6},
        "mrays_per_s": spread(rate),
        "embree": [],
        "povray_seconds": spread(4.0),
    }


FRAMES = {
    "command": "bench frames",
    "size": [32, 24],
    "depth": 2,
    "repeat": 1,
    "frames": [frame("a/balls.nff.gz", 8), frame("$no$ formula & <tag>.nff", 2)],
}


def point(group, name, seconds, rmse, on_front):
    return {
        "group": group,
        "name": name,
        "label": name,
        "seconds": spread(seconds),
        "error": {"rmse": rmse},
        "on_front": on_front,
    }


ACCURACY = {
    "command": "bench accuracy",
    "size": [32, 32],
    "repeat": 1,
    "runs": [
        {
            "scene": "balls",
            "device": "a device",
            "reference": {"own_error": 1e-4},
            "points": [
                point("samples at depth 16", "1 spp", 0.1, 0.1, True),
                point("samples at depth 16", "4 spp", 0.3, 0.05, True),
                point("base, other depth", "none", 0.3, 0, False),
            ]
            + [
                point("base, other traversal or tree: the same picture", f"row {i}", 0.2 + 0.001 * i, 0.07, False)
                for i in range(30)
            ],
            "povray": {"points": [point("POV-Ray", "-A", 1, 0.06, True)]},
        }
    ],
}


def row(scheme, seconds, busy, timeline=None):
    return {
        "scheme": scheme,
        "queues": 2,
        "speed_up": 8 / seconds if seconds else None,
        "busy_seconds": busy,
        "seconds": seconds and spread(seconds),
        "shares_cores": False,
        "timeline": timeline,
    }


MODES = {
    "command": "bench modes",
    "size": [32, 32],
    "depth": 2,
    "repeat": 1,
    "network": None,
    "runs": [
        {
            "scene": "balls",
            "device": "a device",
            "cores": 2,
            "model": None,
            "rows": [row("pdprt bag", 4.0, 6.0), row("odprt pilot", 8.0, 10.0), row("odprt sah", None, None)],
        }
    ],
}


def engine(name, seconds, lost, other):
    counts = {"rays": 2000, "judged": 1000, "lost": lost, "false": [0, 0], "other": other}
    return {"engine": name, "seconds": seconds, **counts}


AIMED = {
    "command": "bench aimed",
    "processor": "a processor",
    "cores": 1,
    "runs": [
        {
            "numbers": "float",
            "rows": [engine("kdray-double", 0.001, [0, 0], [0, 0]), engine("open3d", 0.0005, [1, 2], [3, 4])],
        },
        {"numbers": "float", "rows": [engine("open3d", 0.0005, [0, 3], [7, 0])]},
        {"numbers": "double", "rows": [engine("kdray-double", 0.002, [0, 0], [0, 0])]},
    ],
}


def figures(report):
    return dict(plot.DRAW[report["command"]](report))


def texts(axes):
    return [text.get_text() for text in axes.texts]


class Plot(unittest.TestCase):
    def test_bars_are_what_was_measured_and_nothing_else(self):
        (axes,) = figures(FRAMES)[""].axes
        self.assertEqual([bar.get_height() for bar in axes.patches], [8, 2, 0.5, 0.5])  # POV-Ray: 2 million in 4 s
        self.assertEqual([t.get_text() for t in axes.get_xticklabels()], ["balls", "$no$ formula & <tag>"])
        legend = [t.get_text() for t in figures(FRAMES)[""].legends[0].get_texts()]
        self.assertFalse(any("Embree" in name for name in legend))

    def test_time_goes_into_bars_that_add_up(self):
        (axes,) = figures(MODES)["_time"].axes
        self.assertEqual([bar.get_height() for bar in axes.patches], [6 / 8, 4 / 8, 6 / 8])

    def test_timelines_begin_with_the_first_span_and_leave_rows_without_one_out(self):
        self.assertNotIn("_timeline", figures(MODES))
        report = copy.deepcopy(MODES)
        spans = [{"ph": "X", "name": "launch", "tid": q, "ts": 5000 + 1000 * q, "dur": 3000} for q in (0, 1)]
        report["runs"][0]["rows"][0]["timeline"] = {"traceEvents": [{"ph": "M", "tid": 0}] + spans}
        (axes,) = figures(report)["_timeline"].axes
        self.assertEqual([t.get_text() for t in axes.get_yticklabels()], ["pdprt bag"])
        self.assertEqual([b.get_paths()[0].get_extents().x0 for b in axes.collections], [0, 1])
        self.assertEqual(texts(axes), [" 4 ms"])

    def test_points_are_drawn_once_and_labels_cover_nothing(self):
        (axes,) = figures(ACCURACY)[""].axes
        drawn = [line for line in axes.lines if line.get_marker() == "o"]
        self.assertEqual(len(drawn), 33)  # one has no error, which a logarithmic axis can't show
        labels = [
            text for text in axes.texts if text.get_text() in ("1 spp", "4 spp", "-A") or text.get_text()[:3] == "row"
        ]
        self.assertIn("1 spp", texts(axes))
        self.assertLess(len(labels), 33)  # there is no space for all of those in a row
        axes.figure.draw_without_rendering()  # annotations find their places
        boxes = [plot.matplotlib.text.Text.get_window_extent(text).padded(-1) for text in labels]  # without the leader
        for i, box in enumerate(boxes):
            self.assertFalse(any(box.overlaps(other) for other in boxes[:i]), labels[i])

    def test_wrong_hits_are_summed_over_scenes_and_none_is_shown_as_such(self):
        floats, doubles = figures(AIMED)[""].axes
        for axes in (floats, doubles):
            self.assertLess(axes.get_ylim()[0], 0)
        dots = [
            [tuple(map(float, line.get_xydata()[0])) for line in axes.lines if line.get_marker() == "o"]
            for axes in (floats, doubles)
        ]
        # Rings, then dots, of each engine; kdray's lie on top. Of 2000 judged rays 6 are lost, and 14 are other.
        self.assertEqual(dots, [[(4, 3000), (4, 10000), (2, 0), (2, 0)], [(1, 0), (1, 0)]])

    def test_a_staircase_has_the_error_that_can_be_had_in_a_given_time(self):
        self.assertEqual(plot.staircase([(1, 9), (4, 5), (6, 2)]), [(1, 9), (4, 9), (4, 5), (6, 5), (6, 2)])
        self.assertTrue(math.isnan(plot.staircase([])[0][0]))

    def test_lines_leave_out_what_an_axis_can_not_show(self):
        axes = plot.Page("t", "", 1).panel("p", log="y")
        plot.draw_line(axes, [(1, 1), (2, 0), (3, None), (4, math.inf), (5, 2)], "#123456")
        self.assertEqual(list(axes.lines[0].get_xdata()), [1, 5])

    def test_files_have_the_same_bytes_each_time(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "frames.json"
            file.write_text(json.dumps(FRAMES))
            plot.draw(file)
            first = file.with_suffix(".svg").read_bytes()
            plot.draw(file)
            self.assertEqual(file.with_suffix(".svg").read_bytes(), first)
            self.assertIn(b">$no$ formula &amp; &lt;tag&gt;<", first)

    def test_what_is_no_report_is_refused_in_a_line(self):
        with tempfile.TemporaryDirectory() as folder:
            for text in ("", "{", "[]", '{"command": "render"}'):
                file = pathlib.Path(folder) / "some.json"
                file.write_text(text)
                with (
                    self.assertRaisesRegex(SystemExit, "kdray: no plot: .*some.json: "),
                    contextlib.redirect_stderr(io.StringIO()),
                ):
                    plot.draw(file)


if __name__ == "__main__":
    unittest.main()
