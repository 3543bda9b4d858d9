#!/usr/bin/env python3
"""The modules of host/ see each other one way only. A module is a folder with a CMakeLists.txt, host/GROUP/NAME or host/NAME, and a
library. Checks every #include of a module's files against the links that its CMakeLists.txt states, so that a wrong include fails even
where the include path would let it through; that a group links only itself and groups above it in host/CMakeLists.txt; and that bench/
sees the modules and none of them sees it. The folders of bench/ are one library, and they see each other one way only as well.
Public headers, included as "kdray/NAME.h", are for all; those that declare the interface itself are for modules above it."""

import pathlib
import re
import sys

INTERFACE = ("kdray.h", "scene.h")  # of host/include/kdray

root = pathlib.Path(sys.argv[1])
host = root / "host"
order = re.search(r"foreach\(module\s+(.*?)\)", (host / "CMakeLists.txt").read_text(), re.S)[1].split()
folder_of, links = {}, {}
for path in order:
    text = (host / path / "CMakeLists.txt").read_text()
    own = re.findall(r"(?:kdray_module\(|add_library\(kdray::)(\w+)", text)
    for library in own:
        folder_of[library] = path
    links[path] = set(re.findall(r"kdray::(\w+)", text)) - set(own)
direct = {path: {folder_of[name] for name in names if name in folder_of} - {path} for path, names in links.items()}
modules_by_depth = sorted(order, key=len, reverse=True)


def reachable(start, edges):
    seen, todo = set(), list(edges.get(start, ()))
    while todo:
        other = todo.pop()
        if other not in seen:
            seen.add(other)
            todo.extend(edges.get(other, ()))
    return seen


def module_of(path):
    """The module that a path below host/ belongs to: the deepest one."""
    return next((module for module in modules_by_depth if path.startswith(module + "/")), None)


def includes(folder):
    """The file, the line and the path of each #include of a kdray header."""
    for file in sorted(folder.rglob("*")):
        if file.suffix in (".h", ".cpp"):
            for number, line in enumerate(file.read_text().splitlines(), 1):
                if include := re.match(r'#include "([^"]+)"', line):
                    yield file, number, include[1]


faults = []
for file, number, path in includes(host):
    module = module_of(str(file.relative_to(host)))
    if module is None:
        continue
    other = module_of(path)
    if path.startswith("kdray/") and path.split("/")[1] in INTERFACE:
        other = "api"
    if path.startswith("bench/"):
        faults.append(f"{file}:{number}: module {module} includes {path}")
    if other and other != module and other not in reachable(module, direct):
        faults.append(f"{file}:{number}: module {module} includes {other}/, which it doesn't link")

groups = list(dict.fromkeys(path.split("/")[0] for path in order))
for module, others in direct.items():
    if module in reachable(module, direct):
        faults.append(f"host/{module}: the module depends on itself by way of others")
    for other in others:
        if groups.index(other.split("/")[0]) > groups.index(module.split("/")[0]):
            faults.append(f"host/{module}: it links {other}, whose group stands below its own")

seen_by = {}
for file, number, path in includes(root / "bench"):
    own, parts = file.relative_to(root / "bench").parts[0], path.split("/")
    if parts[0] == "bench" and parts[1] != own:
        seen_by.setdefault(own, {})[parts[1]] = f"{file}:{number}"
for folder, places in sorted(seen_by.items()):
    for other, place in sorted(places.items()):
        if folder in reachable(other, seen_by):
            faults.append(f"{place}: bench/{folder} and bench/{other} include each other")
print("\n".join(faults) or f"{len(order)} modules in {len(groups)} groups, no include against their links")
sys.exit(bool(faults))
