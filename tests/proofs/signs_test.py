# What    Proves in Coq, over Flocq, what bounds take as given (rounding.v, inequalities.v), and that triangles see opposite
#         signs of a shared edge's function (kahan.v, watertight.v), of the kernels' source as it is; and that this fails for
#         each mutant of it in signs.kernel.
#         signs_test.py COMPILER PROJECT [print]
# Errors  Status 1 when it isn't proved or a mutant is; 77 where Coq or Flocq isn't installed.
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from bound import Bound
from bounds_test import changed_kernels
from kernel_source import Broken

FOLDER = pathlib.Path(__file__).parent
LIBRARY = {"ClassicalDedekindReals", "FunctionalExtensionality", "Classical_Prop"}  # what Coq's reals take for granted


def coq(folder, name):
    """Compiles a file; returns what is wrong with it."""
    done = subprocess.run(["coqc", "-q", f"{name}.v"], cwd=folder, capture_output=True, text=True, timeout=600)
    assumed = re.findall(r"^(\w+)\S* :|^(\w+)\S*$", done.stdout, re.MULTILINE)
    assumed = {first or second for first, second in assumed} - LIBRARY - {"Axioms"}
    if done.returncode == 0 and not assumed:
        return None
    return done.stderr.strip().replace("\n", " ") or f"takes for granted: {', '.join(assumed)}"


def why_not(folder, compiler, kernels):
    try:
        text = Bound((FOLDER / "signs.kernel").read_text()).coq(compiler, kernels)
    except Broken as broken:
        return str(broken)
    (folder / "KernelSource.v").write_text(text)
    return coq(folder, "KernelSource") or coq(folder, "watertight")


def main():
    compiler, project = sys.argv[1], pathlib.Path(sys.argv[2])
    kernels = project / "kernels"
    bound = Bound((FOLDER / "signs.kernel").read_text())
    if sys.argv[3:] == ["print"]:
        print(bound.coq(compiler, [kernels]))
        return 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "flocq.v").write_text("From Flocq Require Import Core.\n")
        if shutil.which("coqc") is None or coq(folder, "flocq"):
            print("skipped: Coq with Flocq isn't installed (Debian: apt-get install coq libcoq-flocq)")
            return 77
        for file in FOLDER.glob("*.v"):
            shutil.copy(file, folder)
        failed = False
        for file in ("rounding", "inequalities", "kahan", "watertight"):
            wrong = why_not(folder, compiler, [kernels]) if file == "watertight" else coq(folder, file)
            print(f"{file}: {wrong or 'proved'}")
            failed |= wrong is not None
        for text in bound.directives("mutant"):
            with changed_kernels(kernels, text) as changed:
                wrong = why_not(folder, compiler, [changed, kernels])
            print(f"mutant: {text}: {'refuted: ' + wrong if wrong else 'is proved, too'}")
            failed |= wrong is None
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
