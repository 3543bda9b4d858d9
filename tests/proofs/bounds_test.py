# What    Proves the bounds (bound.py): Gappa must prove each as the kernels' source is; and must fail, or the source
#         not be understood any more, for each mutant of the source that a bound names:
#           %mutant FILE: TEXT => TEXT
#         bounds_test.py COMPILER PROJECT [proved|refuted|print] [BOUND...]
# Errors  Status 1 when a bound isn't proved or a mutant is; 77 where Gappa isn't installed.
import contextlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor

from bound import FOLDER, Bound
from kernel_source import Broken

GAPPA = ["gappa", "-Edichotomy=12"]


def gappa(script):
    """Returns why Gappa doesn't prove a script; nothing when it does."""
    with subprocess.Popen(GAPPA, stdin=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        process.stdin.write(script)
        process.stdin.close()
        last = ""
        for line in process.stderr:  # hints are checked first, and a wrong one may keep Gappa busy for long
            if "not trivially equal" in line:
                process.kill()
                return f"a hint is no equation: {line.strip()}"
            if line.startswith("Error: ") and not re.search("not satisfied|no contradiction", line):
                process.kill()
                raise SystemExit(f"a bound isn't Gappa's language: {line}{script}")
            last = line.strip() or last
    return None if process.returncode == 0 else f"not proved: {last}"


def why_not(bound, compiler, kernels):
    try:
        return gappa(bound.gappa(compiler, kernels))
    except Broken as broken:
        return f"the source isn't as the bound has it: {broken}"


@contextlib.contextmanager
def changed_kernels(kernels, text):
    """A folder with the file that a mutant changes."""
    file, change = text.split(": ", 1)
    old, new = change.split(" => ")
    path = kernels / file if (kernels / file).exists() else kernels.parent / file
    source = path.read_text()
    if source.count(old) != 1:
        raise SystemExit(f"{source.count(old)} times in {file}: {old}")
    with tempfile.TemporaryDirectory() as folder:
        changed = pathlib.Path(folder) / file
        changed.parent.mkdir(parents=True)
        changed.write_text(source.replace(old, new))
        yield folder


def mutant(bound, text, compiler, kernels):
    """Returns whether a mutant fails as it should, and why."""
    with changed_kernels(kernels, text) as folder:
        why = why_not(bound, compiler, [folder, kernels])
        return why is not None, f"{text}: {why or 'is proved, too'}"


def proof(bound, compiler, kernels):
    """Returns whether a bound is proved, and why not."""
    why = why_not(bound, compiler, [kernels])
    return why is None, why or "proved"


def all_bounds():
    return {path.stem: Bound(path.read_text()) for path in sorted(FOLDER.glob("*.bound"))}


def report(cases):
    """Runs cases, of a name and a function, as many at once as there are cores; returns the exit status."""

    def timed(case):
        start = time.monotonic()
        return case[0], *case[1](), time.monotonic() - start

    failed = 0
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for name, passed, text, seconds in pool.map(timed, cases):
            failed += not passed
            print(f"{'ok' if passed else 'FAILED'} {name}: {text} ({seconds:.1f} s)")
    return 1 if failed else 0


def main():
    compiler, project, what = sys.argv[1], pathlib.Path(sys.argv[2]), (sys.argv[3:] or ["proved"])[0]
    if shutil.which("gappa") is None and what != "print":
        print("skipped: Gappa isn't installed (Debian: apt-get install gappa)")
        return 77
    kernels = project / "kernels"
    bounds = {name: bound for name, bound in all_bounds().items() if not sys.argv[4:] or name in sys.argv[4:]}
    if what == "print":
        for bound in bounds.values():
            print(bound.gappa(compiler, [kernels]))
        return 0
    cases = []
    for name, bound in bounds.items():
        if what == "proved":
            cases.append((name, lambda bound=bound: proof(bound, compiler, kernels)))
            continue
        mutants = bound.directives("mutant")
        cases += [(name, lambda b=bound, m=m: mutant(b, m, compiler, kernels)) for m in mutants]
        if not mutants:
            cases.append((name, lambda: (False, "names no mutant")))

    return report(cases)


if __name__ == "__main__":
    sys.exit(main())
