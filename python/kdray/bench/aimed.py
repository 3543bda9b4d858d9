"""Error against time: rays aimed at where rounding decides, and how many of each engine's hits are wrong.

A mesh comes twice, with coordinates that are floats and with such that are doubles, and what is right is exact for
these numbers (`exact`). Who computes in float is given the doubles rounded. A hit is wrong that is *lost* (the ray
meets something), *false* (it meets nothing), or of an *other* triangle than those that lie nearest; a count of
crossings is by its *parity*. Times are the processor's, from arrays to arrays, of all rays in one call.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from .engines import KINDS, Answer, Engine
from .exact import Exact
from .workload import Array, Mesh, Query

AIMS = ("vertices", "edges", "planes", "grazing")
GRAZING = AIMS.index("grazing")
SLOW = 10  # seconds


def in_doubles(mesh: Mesh, seed: int) -> Mesh:
    """The mesh with coordinates that are no floats, each within half a last place of what it was."""
    apart = np.random.default_rng(seed).uniform(-(2.0**-25), 2.0**-25, mesh.vertices.shape)
    return replace(mesh, vertices=mesh.vertices * (1 + apart))


def aim(mesh: Mesh, n: int, seed: int) -> Query:
    """So many rays of each of AIMS, in the precision of the vertices, from 2^-7 to 2 times the mesh's size away.

    They go to vertices; to edges; to vertices in planes across an axis, as cells of trees are bounded by; and grazing,
    in the plane of a triangle through its corner and then over it, every other one along its edge.
    """
    random = np.random.default_rng(seed)
    which = random.integers(len(mesh.triangles), size=(len(AIMS), n))
    a, b, c = np.moveaxis(mesh.vertices.astype(np.float64)[mesh.triangles[which]], 2, 0)
    to_b, to_c = random.normal(size=(2, len(AIMS), n, 1))
    around = random.normal(size=a.shape)
    around[2][np.arange(n), random.integers(3, size=n)] = 0
    to_c[GRAZING, ::2] = 0
    around[GRAZING] = -(np.abs(to_b) * (b - a) + np.abs(to_c) * (c - a))[GRAZING]
    around /= np.linalg.norm(around, axis=-1, keepdims=True)
    ends = a.copy()
    ends[1] += random.uniform(0, 1, (n, 1)) * (b - a)[1]
    starts = (ends + mesh.size * 2.0 ** random.uniform(-7, 1, to_b.shape) * around).astype(mesh.vertices.dtype)
    directions = ends - starts
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    return Query(starts.reshape(-1, 3), directions.reshape(-1, 3).astype(mesh.vertices.dtype))


class Right:
    """What is right of so many rays of each aim; those that may touch a surface alone are `sure` of nothing."""

    def __init__(self, mesh: Mesh, query: Query) -> None:
        assert query.directions is not None
        exact = Exact(mesh.vertices, mesh.triangles)
        self.t, nearest, self.crossings, touches = exact.ask(query.origins, query.directions)
        self.sure = ~touches
        self.triangles = len(mesh.triangles)
        self.nearest = np.concatenate([triangles + i * self.triangles for i, triangles in enumerate(nearest)])

    def judge(self, answer: Answer, count: Array | None, step: int = 1) -> dict[str, Any]:
        """Of every so manieth ray: wrong hits and parities of each aim, and how far off right hits' t is, of itself.

        That of grazing ones is left out: it may be anything within the triangle.
        """
        assert answer.primitive is not None
        t, sure = self.t[::step], self.sure[::step]
        here, there = np.isfinite(answer.values), np.isfinite(t)
        known = np.arange(len(self.t))[::step] * self.triangles + answer.primitive.astype(np.int64)
        right = here & there & np.isin(known, self.nearest)
        parity = None if count is None else (count - self.crossings[::step]) % 2 != 0
        plain = right & (np.arange(len(t)) < len(t) // len(AIMS) * GRAZING)
        off = np.abs(answer.values[plain].astype(np.float64) - t[plain]) / t[plain]

        def of_each(which: Array) -> list[int]:
            counts: list[int] = (which & sure).reshape(len(AIMS), -1).sum(axis=1).tolist()
            return counts

        return {
            "rays": len(t),
            "judged": int(np.count_nonzero(sure)),
            "lost": of_each(~here & there),
            "false": of_each(here & ~there),
            "other": of_each(here & there & ~right),
            "parity": None if parity is None else of_each(parity),
            "t_off": {"median": float(np.median(off)), "largest": float(off.max())} if len(off) else None,
        }


def timed(engine: Engine, query: Query, rounds: int) -> tuple[Answer, float]:
    """The answers, and the median time of so many rounds after a first; of that alone where it takes long."""
    given = engine.prepare("closest", query)
    seconds: list[float] = []
    for _ in range(rounds + 1):
        start = time.process_time()
        result = engine.run("closest", given)
        seconds.append(time.process_time() - start)
        if seconds[0] > SLOW:
            break
    return engine.answer("closest", query, result), statistics.median(seconds[1:] or seconds)


def run(mesh: Mesh, names: Sequence[str], n: int, rounds: int, threads: int, seed: int) -> Iterator[dict[str, Any]]:
    """A scene's figures, with floats and with doubles; `n` is rounded up so that slow engines' share is whole."""
    n = -(-n // 10) * 10
    for numbers in ("float", "double"):
        given = mesh if numbers == "float" else in_doubles(mesh, seed)
        query = aim(given, n, seed)
        right = Right(given, query)
        rows = []
        for name in names:
            engine = KINDS[name](given, threads)
            asked = query.every(engine.share)
            answer, seconds = timed(engine, asked, rounds)
            judged = right.judge(answer, engine.count(asked), engine.share)
            rows.append({"engine": name, "seconds": seconds, **judged})
        about = {"scene": mesh.name, "triangles": len(mesh.triangles), "numbers": numbers}
        yield {**about, "aims": AIMS, "rows": rows}


def table(found: dict[str, Any]) -> list[str]:
    """A scene's figures in Markdown: wrong answers in a million."""
    lines = [
        f"{found['scene']} ({found['triangles']} triangles), {found['numbers']} coordinates",
        "",
        f"| engine | rays | Mrays/s | {' | '.join(AIMS)} | lost or false | parity | t off: median, largest |",
        "|---|" + "---|" * (len(AIMS) + 5),
    ]
    for row in found["rows"]:
        holes = [sum(pair) for pair in zip(row["lost"], row["false"], strict=True)]
        each = [len(AIMS) * sum(pair) for pair in zip(holes, row["other"], strict=True)]
        counts = [*each, sum(holes), None if row["parity"] is None else sum(row["parity"])]
        cells = ["-" if n is None else f"{1e6 * n / row['judged']:.0f}" for n in counts]
        speed, off = row["rays"] / row["seconds"] / 1e6, row["t_off"]
        cells = [
            str(row["judged"]),
            f"{speed:.2g}",
            *cells,
            f"{off['median']:.1g}, {off['largest']:.1g}" if off else "-",
        ]
        lines.append(f"| {row['engine']} | {' | '.join(cells)} |")
    return lines
