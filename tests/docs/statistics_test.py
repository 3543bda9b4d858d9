#!/usr/bin/env python3
"""What    Holds docs/statistics.md against the code: each key that `--stats` of render and trace writes has its row, and no other.
Shape   Each word of the names that rows quote is a key, `tuning.key.device` three. The keys of the sections that tell of an
        object have to be those of the functions that make it. Keys that are computed are left out: of each kind of primitive.
Errors  Status 1, with a line for each key that one side has alone."""

import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
API, CLI, RENDER, TRACE = (f"host/{file}.cpp" for file in ("api/statistics_json", "apps/cli/stats", "apps/cli/render_frame", "apps/cli/trace"))
# Sections of the page, and where their keys are written: by a function, or into an object of `stats`.
PARTS = [
    (["`seconds`"], [(API, "seconds_json")]),
    (["`scene`"], [(API, "scene_json"), (CLI, "scene")]),
    (["`rays`"], [(API, "rays_json")]),
    (["`tree`"], [(API, "tree_json")]),
    (["`memory`"], [(API, "memory_json"), (CLI, "memory")]),
    (["`device`"], [(API, "device_json"), (API, "tuning_json")]),
    (["`mode`"], [(API, "mode_json"), (API, "division_json"), (API, "queue_json")]),
    (["`hits`"], [(TRACE, "answers_told")]),
    (["At the top", "`features` and `programs`", "`frame` and `samples`", "`ledger`"],
     [(API, "statistics_json"), (API, "samples_json"), (CLI, ""), (RENDER, ""), (TRACE, "")]),
]  # fmt: skip
COMPUTED = {"rays", "points"}  # of hits: what is asked about


def keys_written(file, where):
    text = (root / file).read_text()
    body = re.search(rf"^Json {where}\(.*?^}}", text, re.M | re.S) if where else None
    if body:
        found = re.findall(r'\{"(\w+)",|\["(\w+)"\]|put\(\w+, "(\w+)"', body[0])
    else:
        found = re.findall(rf'\bstats\["{where}"\]\["(\w+)"\]' if where else r'\bstats\["(\w+)"\]', text)
    assert found, f"{file} writes nothing in {where or 'stats'} any more: the list of parts is to be mended"
    return {key for groups in found for key in ([groups] if isinstance(groups, str) else groups) if key}


def keys_told(page, section):
    found = re.search(rf"^## {re.escape(section)}\n(.*?)(?=^## |\Z)", page, re.M | re.S)
    assert found, f"the page has no section {section}"
    rows = re.findall(r"^\| (.*?) \|", found[1], re.M)
    return {key for row in rows if not row.startswith("key") for name in re.findall(r"`([\w.]+)`", row) for key in name.split(".")}


page = (root / "docs/statistics.md").read_text()
faults = []
for sections, writers in PARTS:
    told = set().union(*(keys_told(page, section) for section in sections))
    written = set().union(*(keys_written(*writer) for writer in writers))
    names = ", ".join(sections).replace("`", "")
    faults += [f"docs/statistics.md: {names}: no row for {key}" for key in sorted(written - told)]
    faults += [f"docs/statistics.md: {names}: nothing writes {key}" for key in sorted(told - written - COMPUTED)]
print("\n".join(faults) or f"{len(PARTS)} parts of the statistics: each key has its row")
sys.exit(bool(faults))
