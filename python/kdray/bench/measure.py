"""Measuring: engines in turns, and their answers held against each other."""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from .engines import KINDS, POINT_TASKS, RAY_TASKS, Answer, Engine, Kdray
from .workload import Mesh, Query, make_points, make_rays


def different(ours: Answer, theirs: Answer, size: float) -> int:
    """How many answers differ.

    Of rays: only one of the two hits, or they hit different triangles at distances that differ by more than
    1e-4 of themselves (on a common edge, both are right). Of points: distances that differ by more than 1e-5
    of the scene's size.
    """
    a, b = ours.values, theirs.values
    if a.dtype == np.bool_:
        return int(np.count_nonzero(a != b))
    if ours.primitive is None or theirs.primitive is None:
        return int(np.count_nonzero(~(np.abs(a.astype(np.float64) - b) <= 1e-5 * size)))
    both = np.isfinite(a) & np.isfinite(b)
    apart = np.zeros(len(a), np.bool_)
    apart[both] = np.abs(a[both].astype(np.float64) - b[both]) > 1e-4 * np.abs(a[both])
    return int(np.count_nonzero((np.isfinite(a) != np.isfinite(b)) | (apart & (ours.primitive != theirs.primitive))))


@dataclass
class Row:
    """One engine's times for one kind of question."""

    scene: str
    triangles: int
    task: str
    rays: str  # the class, or "points"
    batch: int
    calls: int
    engine: str
    threads: int
    seconds: list[float] = field(default_factory=list)  # of each round, all calls together
    cpu_seconds: list[float] = field(default_factory=list)  # of the same, over all threads
    times_kdray: float | None = None  # its median over that of kdray in as many threads
    cpu_times_kdray: float | None = None
    different: int | None = None  # answers, of `batch`; of the largest batch only

    @property
    def question(self) -> tuple[str, str, str]:
        """What all engines are asked."""
        return self.scene, self.task, self.rays

    @property
    def median(self) -> float:
        """Seconds for a call."""
        return statistics.median(self.seconds) / self.calls

    @property
    def cpu_median(self) -> float:
        """Seconds for a call, over all threads; above 0, whatever the clock's steps are."""
        return max(statistics.median(self.cpu_seconds), 1e-9) / self.calls

    @property
    def per_second(self) -> float:
        """Rays or points."""
        return self.batch / self.median


def measure(
    mesh: Mesh,
    engines: Sequence[Engine],
    task: str,
    name: str,
    query: Query,
    batch: int,
    rounds: int,
    compare: bool,
) -> list[Row]:
    """Times of all engines that know the task, in turns."""
    calls = max(1, min(len(query) // batch, 200 if batch < 100 else 20, 2_000_000 // batch))
    starts = np.linspace(0, len(query) - batch, calls).astype(int)
    parts = [query.part(start, start + batch) for start in starts]
    those = [engine for engine in engines if task in engine.tasks]
    given = [[engine.prepare(task, part) for part in parts] for engine in those]
    rows = [Row(mesh.name, len(mesh.triangles), task, name, batch, calls, e.name, e.threads) for e in those]
    ours: Answer | None = None
    for engine, row, mine in zip(those, rows, given, strict=True):  # the first of them is kdray; this warms up, too
        answer = engine.answer(task, parts[0], engine.run(task, mine[0]))
        if ours is None:
            ours = answer
        elif compare:
            row.different = different(ours, answer, mesh.size)
    for i in range(rounds):
        for k in range(len(those)):
            which = (k + i) % len(those)
            start, cpu = time.perf_counter(), time.process_time()
            for one in given[which]:
                those[which].run(task, one)
            rows[which].seconds.append(time.perf_counter() - start)
            rows[which].cpu_seconds.append(time.process_time() - cpu)
    base = {row.threads: row for row in rows if row.engine == "kdray"}
    for row in rows:
        if row.threads in base:
            row.times_kdray = row.median / base[row.threads].median
            row.cpu_times_kdray = row.cpu_median / base[row.threads].cpu_median
    return rows


def engines_for(mesh: Mesh, names: Iterable[str], threads: int) -> list[Engine]:
    """The engines, kdray first; it comes in one thread, too, where others have no more."""
    made: list[Engine] = [Kdray(mesh, threads)]
    others = [KINDS[name](mesh, threads) for name in names if name != "kdray"]
    if threads != 1 and any(engine.threads == 1 for engine in others):
        made.append(Kdray(mesh, 1))
    return made + others


def run(
    mesh: Mesh,
    names: Sequence[str],
    tasks: Sequence[str],
    classes: Sequence[str],
    options: argparse.Namespace,
) -> Iterator[list[Row]]:
    """All that is asked of one scene, a question at a time."""
    engines = engines_for(mesh, names, options.threads)
    assert isinstance(engines[0], Kdray)
    kinds = [(name, [t for t in tasks if t in RAY_TASKS]) for name in classes]
    kinds.append(("points", [t for t in tasks if t in POINT_TASKS]))
    for name, asked in kinds:
        if not asked:
            continue
        if name == "points":
            query = make_points(mesh, options.points)
        else:
            query = make_rays(mesh, engines[0].scene, name, options.rays)
        sizes = sorted({min(batch, len(query)) for batch in [*options.batches, len(query)]})
        for task in asked:
            for batch in sizes:
                yield measure(mesh, engines, task, name, query, batch, options.rounds, batch == sizes[-1])
