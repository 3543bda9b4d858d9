"""MkDocs' hooks of scripts/site: pages from outside docs/, references made from code, and links between them.

Documents link to one another by their places in the project, as a forge shows them. Here the README, the changelog and
CONTRIBUTING become pages, and so does each example; a link to anything else of the project becomes its name.
"""

from __future__ import annotations

import os
import posixpath
import re
import subprocess
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parent.parent
# Where pages stand in the project that are not in docs/ or have another name there.
PAGES = {
    "README.md": "index.md",
    "docs/README.md": "contents.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
}
LANGUAGES = {".py": "python", ".c": "c", ".cpp": "cpp"}
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")


def examples() -> dict[str, str]:
    """Returns the place of each example in the project, and the page that shows it."""
    found = sorted([*ROOT.glob("examples/*.c*"), *ROOT.glob("python/examples/*.py")])
    return {str(path.relative_to(ROOT)): f"examples/{path.name}.md" for path in found}


def site_page(place: str) -> str | None:
    """Returns the page or file of the site that shows what has this place in the project."""
    shown = PAGES | examples()
    if place in shown:
        return shown[place]
    inside = place.removeprefix("docs/")
    return inside if inside != place and (ROOT / place).is_file() else None


def place_of(page: str) -> str:
    """Returns the place in the project of what a page of the site shows."""
    for place, shown in (PAGES | examples()).items():
        if shown == page:
            return place
    return f"docs/{page}"


def reference() -> str:
    """Returns the page of what is made from code: the options of each command, and links to the rest."""
    text = "# Reference\n\nMade from the code when the site was built.\n\n"
    for folder, what in (("python-api", "the Python package"), ("cpp", "the headers of the C++ and C interfaces")):
        if (ROOT / "build/site-reference" / folder).is_dir():
            text += f'- <a href="{folder}/index.html">{what}</a>\n'
    program = os.environ.get("KDRAY_PROGRAM")
    if not program:
        return text
    overview = _help(program)
    text += f"\n## kdray\n\n```text\n{overview}```\n"
    for command in re.findall(r"^  ([a-z][a-z-]*) ", overview.partition("Subcommands:")[2], re.MULTILINE):
        if told := _help(program, command):
            text += f"\n## kdray {command}\n\n```text\n{told}```\n"
    return text


def _help(program: str, *command: str) -> str:
    # `kdray bench` is a program of its own, which may not be there: then it tells nothing.
    return subprocess.run([program, *command, "--help"], check=False, capture_output=True, text=True).stdout


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Adds the pages that are not in docs/."""
    contents = files.get_file_from_path("README.md")
    if contents is not None:
        files.remove(contents)
    for place, page in PAGES.items():
        files.append(File.generated(config, page, content=(ROOT / place).read_text()))
    for place, page in examples().items():
        name = posixpath.basename(place)
        language = LANGUAGES[posixpath.splitext(name)[1]]
        code = (ROOT / place).read_text()
        files.append(File.generated(config, page, content=f"# {name}\n\n```{language}\n{code}```\n"))
    files.append(File.generated(config, "reference.md", content=reference()))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Makes the links of a page, which are between places in the project, links between pages of the site."""
    here = page.file.src_uri
    folder = posixpath.dirname(place_of(here))

    def follow(match: re.Match[str]) -> str:
        mark, text, target = match.groups()
        if re.match(r"[a-z]+:|#", target):
            return match[0]
        path, _, heading = target.partition("#")
        place = posixpath.normpath(posixpath.join(folder, path))
        shown = site_page(place) or site_page(posixpath.join(place, "README.md"))
        if shown is None:
            return text
        link = posixpath.relpath(shown, posixpath.dirname(here) or ".")
        return f"{mark}[{text}]({link}{'#' + heading if heading else ''})"

    parts = re.split(r"(^```.*?^```$)", markdown, flags=re.MULTILINE | re.DOTALL)
    return "".join(part if part.startswith("```") else LINK.sub(follow, part) for part in parts)
