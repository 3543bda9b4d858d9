#!/usr/bin/env python3
"""The completions of bash, zsh and fish, and the man pages: the shells source what kdray prints, and complete by it.

    shells_test.py KDRAY

bash and zsh run at a terminal, and what is typed ends with the key Tab; fish tells its completions when it is asked. A shell or man
that is not here is left out, with a line that says so. What is expected is taken from --help: an option that is added there is wanted
here. Status 77: there is none of them."""

import os
import pathlib
import pty
import re
import select
import shutil
import subprocess
import sys
import tempfile

kdray = pathlib.Path(sys.argv[1]).resolve()
PATIENCE = 60  # seconds without a sign
# What is typed, and the whole line that becomes of it.
UNIQUE = {
    "kdray rend": "kdray render",
    "kdray render --min-w": "kdray render --min-weight",
    "kdray render --mode pd": "kdray render --mode pdprt",
    "kdray render --mode=od": "kdray render --mode=odprt",
    "kdray render --aov depth,nor": "kdray render --aov depth,normal",
    "kdray render --samples ad": "kdray render --samples adaptive",
    "kdray generate gea": "kdray generate gears",
    "kdray help inf": "kdray help info",
    "kdray render a_mod": "kdray render a_model.glb",
    "kdray render -o a_mod": "kdray render -o a_model.glb",
}


def output_of(*arguments, **options):
    done = subprocess.run(arguments, capture_output=True, text=True, timeout=PATIENCE, **options)
    assert done.returncode == 0, f"{arguments}: status {done.returncode}: {done.stderr}"
    return done.stdout


def options_of(command):
    """The long options that --help lists, each at the beginning of a line."""
    found = re.findall(r"^  (?:-\w, )?(--[a-z0-9-]+)", output_of(kdray, "help", *command.split()), re.MULTILINE)
    assert found, command
    return set(found)


def has_bench():
    return kdray.with_name("kdray-bench").exists()


class Terminal:
    """A shell at a terminal, which is told to print a mark after each line that it was to complete."""

    def __init__(self, command, setup, folder, environment):
        self.process, self.descriptor = pty.fork()
        if self.process == 0:
            os.chdir(folder)
            os.execvpe(command[0], command, environment)
        self.seen = ""
        self.send("PS1= PS2= PROMPT=; stty -echo; " + setup + "; printf 'READY%s\\n' 1\n")
        self.wait_for("READY1")

    def send(self, text):
        os.write(self.descriptor, text.encode())

    def wait_for(self, mark):
        while mark not in self.seen:
            assert select.select([self.descriptor], [], [], PATIENCE)[0], f"no {mark} in {self.seen!r}"
            self.seen += os.read(self.descriptor, 4096).decode(errors="replace")
        before, _, self.seen = self.seen.partition(mark)
        return before

    def completed(self, typed):
        """The command line after a Tab: `kdray` is a function that prints its arguments by now."""
        self.send(typed + "\t\n")
        return self.wait_for("END").rpartition("<")[2].rstrip(" ")

    def close(self):
        os.close(self.descriptor)
        os.waitpid(self.process, 0)


def check_at_terminal(name, command, setup, folder, environment):
    # What is completed is run: a function takes the program's place where the line is a whole command.
    say = 'kdray() { if [ "$1" = --complete ]; then command kdray "$@"; else printf "<kdray %s>END\\n" "$*"; fi; }'
    terminal = Terminal(command, setup + "; " + say, folder, environment)
    for typed, wanted in UNIQUE.items():
        got = terminal.completed(typed).rstrip("> ")
        assert got == wanted, f"{name}: {typed!r} became {got!r}, not {wanted!r}"
    terminal.close()


def check_fish(folder, environment):
    def complete(line):
        script = f"source (kdray --completion fish | psub); complete -C '{line}'"
        return output_of("fish", "--no-config", "-c", script, cwd=folder, env=environment).splitlines()

    for typed, wanted in UNIQUE.items():
        words = [line.split("\t")[0] for line in complete(typed)]
        assert words == [wanted.split(" ")[-1]], f"fish: {typed!r}: {words}"
    assert any("Render a scene" in line for line in complete("kdray rend")), "fish shows no descriptions"


def check_what_kdray_tells():
    """Every option of every command, whatever the shell; none that was given."""
    commands = output_of(kdray, "--complete", "").splitlines()
    assert "render\tRender a scene to a picture" in commands and len(commands) > 8
    for line in commands:
        command = line.split("\t")[0]
        if command == "bench":
            continue
        told = {c.split("\t")[0] for c in output_of(kdray, "--complete", command, "-").splitlines()}
        assert told == options_of(command), f"{command}: {told ^ options_of(command)}"
    for odd in ([], ["="], ["--"], ["--mode="], ["render", "--mode", "=", "="], ["no-such", "-"], ["render", "\n\t", "-" * 9999]):
        output_of(kdray, "--complete", *odd)
    assert "--size" not in output_of(kdray, "--complete", "render", "--size", "9x9", "--s")
    if has_bench():
        assert output_of(kdray, "--complete", "bench", "rays", "--cla").startswith("--classes\t")


def check_man_pages(folder):
    output_of(kdray, "--man", folder)
    if has_bench():
        output_of(kdray.with_name("kdray-bench"), "--man", folder)
        assert (folder / "kdray-bench-rays.1").exists()
    pages = sorted(folder.glob("*.1"))
    assert {"kdray.1", "kdray-render.1", "kdray-warm-up.1"} <= {page.name for page in pages}
    left = []
    for page in pages:
        command = page.stem.removeprefix("kdray").lstrip("-").replace("bench-", "bench ")
        text = page.read_text().replace("\\-", "-")
        for option in options_of(command) if command else ["--version"]:
            assert option in text, f"{page.name} has no {option}"
        if shutil.which("man"):
            shown = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", page], capture_output=True, text=True,
                                   env={**os.environ, "MANWIDTH": "80", "LC_ALL": "C.UTF-8"})  # fmt: skip
            assert shown.returncode == 0 and not shown.stderr, f"man: {page.name}: {shown.stderr}"
        if shutil.which("mandoc"):
            lint = subprocess.run(["mandoc", "-T", "lint", "-W", "warning", page], capture_output=True, text=True).stdout
            # Pages that lie elsewhere, and the day of a source that is no checkout.
            faults = [line for line in lint.splitlines() if "missing date" not in line]
            assert not faults, "\n".join(faults)
    left += [tool for tool in ("man", "mandoc") if not shutil.which(tool)]
    return left


def main():
    environment = {**os.environ, "PATH": f"{kdray.parent}:{os.environ['PATH']}", "TERM": "dumb", "LC_ALL": "C.UTF-8"}
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        environment["HOME"] = name
        (folder / "a_model.glb").touch()
        check_what_kdray_tells()
        (folder / "man").mkdir()
        left = check_man_pages(folder / "man")
        shells = {
            "bash": (["bash", "--norc", "--noprofile", "-i"], "bind 'set enable-bracketed-paste off'; source <(kdray --completion bash)"),
            "zsh": (["zsh", "-f", "-i"], "autoload -Uz compinit; compinit -u -D; source <(kdray --completion zsh)"),
        }
        for shell, (command, setup) in shells.items():
            if shutil.which(shell):
                check_at_terminal(shell, command, setup, folder, environment)
        if shutil.which("fish"):
            check_fish(folder, environment)
        left += [shell for shell in (*shells, "fish") if not shutil.which(shell)]
    print("left out, since it is not here: " + ", ".join(left) if left else "bash, zsh, fish, man and mandoc agree")


main()
