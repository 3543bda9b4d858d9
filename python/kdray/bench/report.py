"""Telling: a table and a plot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .measure import Row

HEAD = f"{'engine':<9}{'threads':>8}{'batch':>9}{'a call':>12}{'M/s':>9}{'x kdray':>9}{'x cpu':>8}{'different':>11}"


def line(row: Row) -> str:
    """A row of the table (HEAD)."""
    call = f"{row.median * 1e3:.2f} ms" if row.median >= 1e-3 else f"{row.median * 1e6:.1f} us"
    ratio, cpu = ("-" if x is None else f"{x:.2f}" for x in (row.times_kdray, row.cpu_times_kdray))
    apart = "-" if row.different is None else str(row.different)
    speed = f"{row.per_second / 1e6:.3f}"
    return f"{row.engine:<9}{row.threads:>8}{row.batch:>9}{call:>12}{speed:>9}{ratio:>9}{cpu:>8}{apart:>11}"


COLOURS = {"kdray": "#c2410c", "embreex": "#64748b", "trimesh": "#94a3b8", "open3d": "#0369a1"}


def plot(rows: Sequence[Row], titles: Sequence[str]) -> str:
    """An SVG with a bar for each engine and question, of the largest batch: millions a second."""
    largest: dict[tuple[str, str, str], int] = {}
    for row in rows:
        largest[row.question] = max(row.batch, largest.get(row.question, 0))
    shown = [row for row in rows if row.batch == largest[row.question]]
    y, parts = 44 + 14 * len(titles), []
    for question, batch in largest.items():
        those = [row for row in shown if row.question == question]
        fastest = max(row.per_second for row in those)
        about = _escaped(f"{', '.join(question)}: {batch} at once")
        parts.append(f'<text x="10" y="{y + 12}" font-weight="bold">{about}</text>')
        for row in those:
            y += 17
            wide = 560 * row.per_second / fastest
            who = f"{row.engine}, {row.threads} thread{'s' if row.threads > 1 else ''}"
            parts.append(f'<text x="150" y="{y + 12}" text-anchor="end">{who}</text>')
            parts.append(f'<rect x="156" y="{y + 2}" width="{wide:.1f}" height="13" fill="{COLOURS[row.engine]}"/>')
            parts.append(f'<text x="{160 + wide:.1f}" y="{y + 12}">{row.per_second / 1e6:.2f}</text>')
        y += 28
    head = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="780" height="{y}"',
        ' font-family="sans-serif" font-size="11">',
        '<rect width="100%" height="100%" fill="white"/>',
        '<text x="10" y="20" font-size="14">Million rays or points a second</text>',
        *(f'<text x="10" y="{36 + 14 * i}" fill="#555">{_escaped(t)}</text>' for i, t in enumerate(titles)),
    ]
    return "\n".join([*head, *parts, "</svg>", ""])


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")


def titles(about: dict[str, Any]) -> list[str]:
    """What stands above the table; the first two lines above the plot."""
    lines = [
        f"{about['processor']}, {about['threads']} of {about['cores']} cores; kdray on {about['device']}",
        ", ".join(f"{name} {version}" for name, version in about["versions"].items()),
        *(f"left out: {name}: {why}" for name, why in about["left_out"].items()),
    ]
    if "embreex" not in about["left_out"]:
        lines.append("embreex, and trimesh on top of it, trace in one thread: kdray in one thread is beside them")
    return [
        *lines,
        "a call: the median time; x kdray: that over kdray's in as many threads; different: answers unlike kdray's",
        "x cpu: as x kdray, of the processor's time over all threads: others' load moves it less",
    ]


def tell(measured: Sequence[Row], before: Row | None) -> None:
    """Writes rows to stdout, under a head where the question is another than `before`'s."""
    first = measured[0]
    if before is None or before.question != first.question:
        print(f"\n{first.scene} ({first.triangles} triangles), {first.task}, {first.rays}\n{HEAD}")
    for row in measured:
        print(line(row), flush=True)
