#!/usr/bin/env python3
"""The rooms of host/ see each other one way only: cli -> api -> pdprt -> wavefront -> device, flatten -> kdtree, scene
-> math, base; bench/ sees them and none of them sees it. Checks every #include of a room's header against the links
that the room's CMakeLists.txt states, so that a wrong include fails even where the include path would let it through.
The folders of bench/ are one library, and they see each other one way only as well.
A public header, included as "kdray/NAME.h", belongs to the room whose folder kdray/ holds it."""

import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1])
folder_of = {p.parent.name: p.parent for p in root.glob("host/*/CMakeLists.txt")} | {"bench": root / "bench"}
rooms = sorted(folder_of)
cmake = {room: (folder_of[room] / "CMakeLists.txt").read_text() for room in rooms}
# A room may hold libraries of other names.
owner = {alias: room for room in rooms for alias in re.findall(r"add_library\(kdray::(\w+) ALIAS", cmake[room])}
owner |= {room: room for room in rooms}
direct = {room: {owner.get(name, name) for name in re.findall(r"kdray::(\w+)", cmake[room])} - {room} for room in rooms}
public = {header.name: header.parent.parent.name for header in root.glob("host/*/kdray/*.h")}


def reachable(start, links):
    seen, todo = set(), list(links.get(start, ()))
    while todo:
        other = todo.pop()
        if other not in seen:
            seen.add(other)
            todo.extend(links.get(other, ()))
    return seen


def includes(folder):
    """The file, the line and the path of each #include of a kdray header."""
    for file in sorted(folder.rglob("*")):
        if file.suffix in (".h", ".cpp"):
            for number, line in enumerate(file.read_text().splitlines(), 1):
                if include := re.match(r'#include "([^"]+)"', line):
                    yield file, number, pathlib.PurePath(include[1])


faults = []
for room in rooms:
    allowed = reachable(room, direct) | {room}
    for file, number, path in includes(folder_of[room]):
        other = public.get(path.name) if path.parts[0] == "kdray" else path.parts[0]
        if other in rooms and other not in allowed:
            faults.append(f"{file}:{number}: room {room} includes {other}/, which it doesn't link")
    if room in reachable(room, direct):
        faults.append(f"{folder_of[room]}: the room depends on itself by way of others")

seen_by = {}
for file, number, path in includes(root / "bench"):
    own = file.relative_to(root / "bench").parts[0]
    if path.parts[0] == "bench" and path.parts[1] != own:
        seen_by.setdefault(own, {})[path.parts[1]] = f"{file}:{number}"
for folder, places in sorted(seen_by.items()):
    for other, place in sorted(places.items()):
        if folder in reachable(other, seen_by):
            faults.append(f"{place}: bench/{folder} and bench/{other} include each other")
print("\n".join(faults) or f"{len(rooms)} rooms, no include against their links")
sys.exit(bool(faults))
