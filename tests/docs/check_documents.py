#!/usr/bin/env python3
"""What    Checks the documents: that every link and every named file exists, and that pages stay short.
Shape   Relative links of all pages, with their anchors; paths in backquotes (host/..., kernels/..., ...) of pages that
        explain how things are now (the logbook may name what is gone); `docs/....md` and other pages named in code;
        source files named in comments, by name or by the end of their path; the length of explanation pages; the
        width of text; links between a page and its logbook both ways.
Errors  Status 1, with a line for each fault: file, line, what is wrong."""

import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
WIDTH = 110
LONGEST = 150  # lines of a page that explains one idea

pages = [root / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "scenes/README.md")]
pages += sorted((root / "docs").rglob("*.md"))
explanations = sorted((root / "docs" / "design").glob("*.md")) + sorted((root / "docs").glob("life-*.md"))
explanations.append(root / "docs" / "traversal.md")
logbook = root / "docs" / "logbook"
wrapped = explanations + sorted(logbook.glob("*.md")) + [root / "docs" / "README.md"]
CODE = {".h", ".cpp", ".c", ".cl", ".clh", ".cmake", ".txt", ".py", ".js", ".sh", ".json", ".nff", ""}
OUTSIDE = {"SOURCES.md"}  # of the test data
FOLDERS = ("host", "kernels", "tests", "bench", "scripts", "scenes", "docs", "cmake", ".ci", "python", "examples")
C_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
OTHER_COMMENT = re.compile(r"#\s[^\n]*|\"\"\".*?\"\"\"", re.DOTALL)
SOURCE = re.compile(r"(?<![\w./<>{}*$-])(?:\.{1,2}/)*(\w[\w./-]*\.(?:h|cpp|c|clh?|py|js|cmake))(?![\w(/-]|\.\w)")
OF_OTHERS = {"src/common/color.c", "tests/generic.py"}  # Radiance's, trimesh's
PLACEHOLDERS = re.compile(r"(.*/)?[A-Z]+(/.*|\.\w+)|file\.cpp|primitives/x/x\.layout\.h")

faults = []


def fault(file, number, text):
    faults.append(f"{file.relative_to(root)}:{number}: {text}")


def lines_of(page):
    """Numbered lines, with a mark whether they are text (True) or an indented or fenced block (False)."""
    fenced, before = False, ""
    for number, line in enumerate(page.read_text().splitlines(), 1):
        if line.startswith("```"):
            fenced = not fenced
        block = fenced or (line.startswith("    ") and (before == "" or before.startswith("    ")))
        yield number, line, not block
        before = line


def anchors_of(page):
    """GitHub's anchors of a page's headings."""
    found = set()
    for _, line, is_text in lines_of(page):
        heading = re.match(r"#+ (.*)", line) if is_text else None
        if heading:
            plain = re.sub(r"[^\w\- ]", "", heading[1].replace("`", "").lower())
            found.add(plain.replace(" ", "-"))
    return found


def check_link(page, number, target):
    if "://" in target or target.startswith("mailto:"):
        return
    path, _, anchor = target.partition("#")
    file = (page.parent / path).resolve() if path else page
    if not file.exists():
        fault(page, number, f"the link {target} leads nowhere")
    elif anchor and file.suffix == ".md" and anchor not in anchors_of(file):
        fault(page, number, f"{path or page.name} has no heading #{anchor}")


def check_quoted(page, number, text):
    """A path in backquotes; patterns and placeholders are passed over."""
    for quoted in re.findall(r"`([\w./-]+)`", text):
        folder = quoted.split("/")[0]
        if "/" in quoted and folder in FOLDERS and "..." not in quoted and not named(quoted):
            fault(page, number, f"there is no {quoted}")


def named(path):
    """Whether it names a file or folder; `host/engine/pdprt/tiles` may stand for tiles.h and tiles.cpp."""
    there = root / path
    return there.exists() or any(there.parent.glob(there.name + ".*"))


def check_page(page):
    is_log = logbook in page.parents or page.name == "CHANGELOG.md"
    for number, line, is_text in lines_of(page):
        if not is_text:
            continue
        for target in re.findall(r"\]\(([^)\s]+)\)", line):
            check_link(page, number, target)
        if not is_log:
            check_quoted(page, number, line)
        wide = page in wrapped and len(line) > WIDTH and not line.startswith(("|", "!["))
        if wide and " " in line.strip()[:WIDTH] and not re.fullmatch(r"\s*[-*]?\s*\S+", line):
            fault(page, number, f"{len(line)} characters; text is wrapped at {WIDTH}")


def check_length(page):
    n = len(page.read_text().splitlines())
    if n >= LONGEST:
        fault(page, n, f"{n} lines; a page that explains one idea has less than {LONGEST}"
                       " (figures and trials belong into docs/logbook)")


def check_both_ways(page):
    """A page of the logbook and those that it says explain its subject link each other."""
    explained = re.findall(r"\]\((\.\./(?:design/)?[\w-]+\.md)\)", page.read_text().split("\n## ")[0])
    if not explained:
        fault(page, 1, "its head links no page that explains the subject")
    for target in explained:
        other = (page.parent / target).resolve()
        if other.exists() and f"logbook/{page.name}" not in other.read_text():
            fault(other, 1, f"has no link to docs/logbook/{page.name}, which links it")


def check_code(file):
    """Pages that code names: docs/... as a path, others by a name in capitals."""
    try:
        text = file.read_text()
    except UnicodeDecodeError:
        return
    for number, line in enumerate(text.splitlines(), 1):
        for path in re.findall(r"\bdocs/[\w./-]*\w\.(?:md|json|svg|png)\b", line):
            if not (root / path).exists():
                fault(file, number, f"there is no {path}")
        for name in re.findall(r"(?<![\w/.])([A-Z][A-Z_]+\.md)\b", line):
            if name not in OUTSIDE and not (root / name).exists():
                fault(file, number, f"there is no {name}")
    check_comments(file, text)


def check_comments(file, text):
    """Files of sources that comments name: beside the file, or the end of some path."""
    is_c = file.suffix in {".h", ".cpp", ".c", ".cl", ".clh", ".js"}
    for comment in (C_COMMENT if is_c else OTHER_COMMENT).finditer(text):
        for name in SOURCE.finditer(comment[0]):
            known = name[1] in ends or name[1] in OF_OTHERS or PLACEHOLDERS.fullmatch(name[1])
            if not known and not (file.parent / name[0]).exists():
                number = text.count("\n", 0, comment.start() + name.start()) + 1
                fault(file, number, f"there is no {name[0]}, which a comment names")


for page in pages:
    check_page(page)
for page in explanations:
    check_length(page)
for page in sorted(logbook.glob("*.md")):
    if page.name != "README.md":
        check_both_ways(page)
code = [f for folder in FOLDERS if folder != "docs" for f in sorted((root / folder).rglob("*"))]
ends = {"/".join(f.parts[i:]) for f in code for i in range(len(root.parts), len(f.parts))}
code = [f for f in code + [root / "CMakeLists.txt"] if f.is_file() and f.suffix in CODE and f.stat().st_size < 1 << 20]
for file in code:
    check_code(file)
print("\n".join(faults) or f"{len(pages)} pages and {len(code)} files: nothing leads nowhere")
sys.exit(bool(faults))
