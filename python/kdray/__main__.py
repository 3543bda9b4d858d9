"""`python -m kdray doctor` tells what this package has to trace with; other words go to the command line.

`kdray ...` in a shell is the same command line (docs/cli.md), with the same drivers.
"""

from __future__ import annotations

import os
import sys

from . import _drivers


def command_line() -> None:
    """Becomes the program `kdray`, which came with this package."""
    _drivers.choose()
    program = _drivers.program()
    if not program.exists():
        sys.exit("kdray: this build of the package has no command line beside it; build the target kdray_cli")
    os.execv(program, ["kdray", *sys.argv[1:]])


def main() -> None:
    """Runs the package's own commands, and the command line for all others."""
    if sys.argv[1:2] == ["doctor"]:
        from .doctor import doctor

        sys.exit(doctor())
    if sys.argv[1:2] == ["bench"]:
        from .bench import main as bench

        sys.exit(bench(sys.argv[2:]))
    command_line()


if __name__ == "__main__":
    main()
