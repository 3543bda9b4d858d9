"""The command line of `python -m kdray.bench`."""

from __future__ import annotations

import argparse
import json
import pathlib
import sys
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Any

from ..devices import devices
from ..errors import Error, InputError, NoDeviceError
from . import aimed, campaign
from .engines import ENGINES, KINDS, NEEDS, TASKS
from .machine import cores, module, processor, versions
from .measure import Row, run
from .report import plot, tell, titles
from .workload import BUILT_IN, CLASSES, read, room, sphere


def _some_of(all_: Sequence[str]) -> Callable[[str], list[str]]:
    def read_them(text: str) -> list[str]:
        names = text.split(",")
        for name in names:
            if name not in all_:
                raise argparse.ArgumentTypeError(f"there is no {name!r}; there are {', '.join(all_)}")
        return names

    return read_them


def _numbers(text: str) -> list[int]:
    return [_count(part) for part in text.split(",")]


def _count(text: str) -> int:
    try:
        number = int(float(text))  # 1e6, too
    except (ValueError, OverflowError) as why:
        raise argparse.ArgumentTypeError(f"{text!r} is no number") from why
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is less than 1")
    return number


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m kdray.bench", description=(__doc__ or "").replace("`", ""))
    parser.add_argument("scenes", nargs="*", help="sphere, room (the default: both), or mesh files")
    parser.add_argument("--rays", type=_count, metavar="N", help="of each class (1000000), aim (10000), unit (20000)")
    parser.add_argument("--points", type=_count, default=100_000, metavar="N", help="of the others (100000)")
    parser.add_argument(
        "--batches", type=_numbers, default=[1, 1000], metavar="N,N", help="beside all at once (1,1000)"
    )
    parser.add_argument("--rounds", type=_count, default=5, metavar="N", help="the median is reported (5)")
    parser.add_argument("--threads", type=_count, default=cores(), metavar="N", help="of kdray and Open3D (all cores)")
    parser.add_argument(
        "--classes", type=_some_of(CLASSES), default=list(CLASSES), metavar="NAMES", help=", ".join(CLASSES)
    )
    parser.add_argument("--tasks", type=_some_of(TASKS), default=list(TASKS), metavar="NAMES", help=", ".join(TASKS))
    parser.add_argument("--engines", type=_some_of(tuple(KINDS)), metavar="NAMES", help=", ".join(KINDS))
    parser.add_argument(
        "--reports", action="store_true", help="in place of times: wrong answers where others' users reported such"
    )
    parser.add_argument(
        "--aimed", action="store_true", help="wrong hits beside times, of rays at vertices, edges, planes, and grazing"
    )
    parser.add_argument(
        "--seed", type=int, default=1, metavar="N", help="of aimed rays, or a campaign's first unit (1)"
    )
    parser.add_argument(
        "--campaign", metavar="FOLDER", help="random scenes, and what kdray answers wrongly, added to that ledger"
    )
    parser.add_argument("--units", type=_count, default=100, metavar="N", help="of a campaign (100)")
    parser.add_argument("--json", metavar="FILE", help="write all figures")
    parser.add_argument("--plot", metavar="FILE.svg", help="write bars of the largest batch")
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Measures, or runs a campaign's units; the status: 0, 2 for bad input, 3 without a device, else 1."""
    options = _parser().parse_args(argv)
    try:
        if options.campaign:
            return _campaign(options)
        _reports() if options.reports else _bench(options)
    except (Error, OSError) as error:
        print(f"kdray bench: {error}", file=sys.stderr)
        return 2 if isinstance(error, InputError) else 3 if isinstance(error, NoDeviceError) else 1
    return 0


def _campaign(options: argparse.Namespace) -> int:
    """1 where a unit of this run has differences, or Ctrl-C ended it."""
    folder = pathlib.Path(options.campaign)
    files = [read(scene) for scene in options.scenes]
    try:
        bad = campaign.go_on(folder, options.units, options.rays or 20_000, files, options.seed)
    except KeyboardInterrupt:
        bad = 1
    print(campaign.totals(folder))
    return int(bad > 0)


def _reports() -> None:
    """A table of wrong answers: from here, since what it asks is imported with it."""
    from .peers import PEERS
    from .reports import told

    peers = [peer for peer in PEERS if all(module(needed) is not None for needed in peer.needs)]
    left_out = [peer.name for peer in PEERS if peer not in peers]
    print(f"{processor()}; wrong answers, '-' where there is no such question")
    if left_out:
        print(f"left out, as they can't be imported: {', '.join(left_out)}")
    print("\n".join(["", *told(peers)]))


def _aimed(options: argparse.Namespace, names: list[str], about: dict[str, Any]) -> None:
    """Wrong hits beside times, of scenes that exact arithmetic can be asked about."""
    print("\n".join(titles(about)[: 2 + len(about["left_out"])]))
    runs = []
    built_in = {"sphere": lambda: sphere(96), "room": lambda: room(1500)}
    for scene in options.scenes or built_in:
        mesh = built_in[scene]() if scene in built_in else read(scene)
        for found in aimed.run(mesh, names, options.rays, options.rounds, options.threads, options.seed):
            print("\n".join(["", *aimed.table(found)]), flush=True)
            runs.append(found)
    if options.json:
        text = json.dumps({"command": "bench aimed", "seed": options.seed, **about, "runs": runs})
        lines = text.replace('{"scene"', '\n{"scene"').replace('{"engine"', '\n{"engine"')  # one for each engine
        pathlib.Path(options.json).write_text(lines + "\n")


def _bench(options: argparse.Namespace) -> None:
    options.threads = min(options.threads, cores())
    for path in filter(None, (options.json, options.plot)):
        if not pathlib.Path(path).absolute().parent.is_dir():
            raise InputError(f"{path}: there is no such folder")
    names, left_out = [], {}
    for name in options.engines or (KINDS if options.aimed else ENGINES):
        missing = [needed for needed in NEEDS[name] if module(needed) is None]
        if missing:
            left_out[name] = f"{', '.join(missing)} can't be imported"
        else:
            names.append(name)
    options.rays = options.rays or (10_000 if options.aimed else 1_000_000)
    device = next((device.name for device in devices() if device.usable), "")
    about = {
        "processor": processor(),
        "cores": cores(),
        "device": device,
        "versions": versions(),
        "left_out": left_out,
        **{name: getattr(options, name) for name in ("threads", "rays", "points", "rounds")},
    }
    if options.aimed:
        _aimed(options, names, about)
        return
    lines = titles(about)
    print("\n".join(lines))
    rows: list[Row] = []
    for scene in options.scenes or BUILT_IN:
        mesh = BUILT_IN[scene]() if scene in BUILT_IN else read(scene)
        for measured in run(mesh, names, options.tasks, options.classes, options):
            tell(measured, rows[-1] if rows else None)
            rows += measured
    if options.json:
        figures = [asdict(row) | {"median": row.median, "per_second": row.per_second} for row in rows]
        pathlib.Path(options.json).write_text(json.dumps({**about, "rows": figures}, indent=1) + "\n")
    if options.plot:
        pathlib.Path(options.plot).write_text(plot(rows, lines[:2]))
