#!/usr/bin/env python3
"""The rooms of host/ see each other one way only: cli -> api -> pdprt -> wavefront -> device, flatten -> kdtree, scene
-> math, base. Checks every #include of a room's header against the links that the room's CMakeLists.txt states, so
that a wrong include fails even where the include path would let it through."""

import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1]) / "host"
rooms = sorted(p.parent.name for p in root.glob("*/CMakeLists.txt"))


def links(room):
    text = (root / room / "CMakeLists.txt").read_text()
    return {name for name in re.findall(r"kdray::(\w+)", text) if name != room}


direct = {room: links(room) for room in rooms}
direct.setdefault("interface", {"base"})


def reachable(room, seen=None):
    seen = set() if seen is None else seen
    for other in direct.get(room, ()):
        if other not in seen:
            seen.add(other)
            reachable(other, seen)
    return seen


faults = []
for room in rooms:
    allowed = reachable(room) | {room}
    for file in sorted((root / room).rglob("*")):
        if file.suffix not in (".h", ".cpp"):
            continue
        for number, line in enumerate(file.read_text().splitlines(), 1):
            include = re.match(r'#include "(\w+)/', line)
            if include and include[1] in rooms and include[1] not in allowed:
                faults.append(f"{file}:{number}: room {room} includes {include[1]}/, which it doesn't link")
    if room in reachable(room):
        faults.append(f"{root / room}: the room depends on itself by way of others")
print("\n".join(faults) or f"{len(rooms)} rooms, no include against their links")
sys.exit(bool(faults))
