# What    Proves in Coq, over Flocq:
#         signs   what bounds take as given (rounding.v, inequalities.v), and that triangles see opposite signs of a
#                 shared edge's function (kahan.v, watertight.v), of the kernels' source as it is; and that this fails
#                 for each mutant of it in signs.kernel
#         bounds  what Gappa finds of the bounds: its proofs as Coq checks them, with its hints as lemmas
#         coq_test.py COMPILER PROJECT signs|bounds|print
# Errors  Status 1 when something isn't proved or a mutant is; 77 where Coq, or what it needs, isn't installed.
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from bound import Bound
from bounds_test import GAPPA, all_bounds, changed_kernels, report
from kernel_source import Broken

FOLDER = pathlib.Path(__file__).parent
LIBRARY = {"ClassicalDedekindReals", "FunctionalExtensionality", "Classical_Prop"}  # what Coq's reals take for granted
EQUATION = """Proof.
intros; {unfold}change (Float1 1) with 1%R in *; change (Float1 0) with 0%R in *.
first [ring | field; repeat split; assumption].
Qed.
"""


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


def signs(folder, compiler, kernels):
    for file in FOLDER.glob("*.v"):
        shutil.copy(file, folder)
    failed = False
    for file in ("rounding", "inequalities", "kahan", "watertight"):
        wrong = why_not(folder, compiler, [kernels]) if file == "watertight" else coq(folder, file)
        print(f"{'FAILED' if wrong else 'ok'} {file}: {wrong or 'proved'}")
        failed |= wrong is not None
    for text in Bound((FOLDER / "signs.kernel").read_text()).directives("mutant"):
        with changed_kernels(kernels, text) as changed:
            wrong = why_not(folder, compiler, [changed, kernels])
        print(f"{'ok' if wrong else 'FAILED'} mutant: {text}: {wrong or 'is proved, too'}")
        failed |= wrong is None
    return 1 if failed else 0


def equation_after(proof):
    """The terms have names that `ring` sees through where they are notations, but not as definitions (Gappa 1.6)."""
    names = re.findall(r"^Definition (\w+) :=", proof, flags=re.M)
    return EQUATION.format(unfold=f"unfold {', '.join(reversed(names))} in *; " if names else "")


def proof_of(bound, name, folder, compiler, kernels):
    """Returns whether Coq accepts the proof that Gappa finds, and why not."""
    script = bound.gappa(compiler, [kernels])
    proof = subprocess.run([*GAPPA, "-Bcoq"], input=script, capture_output=True, text=True, timeout=600).stdout
    # Gappa takes its hints as given; they are equations, which Coq proves.
    proof, hints = re.subn(
        r"^Hypothesis (a\d+ : [^.]*(?:\.\d[^.]*)*)\.$",
        lambda hint: f"Lemma {hint[1]}.\n{equation_after(hint.string[: hint.start()])}",
        proof,
        flags=re.M,
    )
    if re.search(r"\b(Hypothesis|Axiom|Parameter|Admitted)\b", proof) or "-> False." not in proof:
        return False, "something is left that Coq doesn't prove"
    (folder / f"{name}.v").write_text(f"Require Import Reals.\n{proof}")
    wrong = coq(folder, name)
    return wrong is None, wrong or f"proved, with {hints} equations"


def main():
    compiler, kernels, what = sys.argv[1], pathlib.Path(sys.argv[2]) / "kernels", sys.argv[3]
    if what == "print":
        print(Bound((FOLDER / "signs.kernel").read_text()).coq(compiler, [kernels]))
        return 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        needs = "From Flocq Require Import Core.\n" if what == "signs" else "Require Import Gappa.Gappa_library.\n"
        (folder / "needs.v").write_text(needs)
        gappa_missing = what == "bounds" and shutil.which("gappa") is None
        if gappa_missing or shutil.which("coqc") is None or coq(folder, "needs"):
            print("skipped: not all is installed (Debian: apt-get install gappa coq libcoq-flocq libcoq-gappa)")
            return 77
        if what == "signs":
            return signs(folder, compiler, kernels)
        bounds = all_bounds().items()
        return report([(n, lambda b=b, n=n: proof_of(b, n, folder, compiler, kernels)) for n, b in bounds])


if __name__ == "__main__":
    sys.exit(main())
