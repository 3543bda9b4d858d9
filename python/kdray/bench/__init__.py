"""`python -m kdray.bench`: the same rays through kdray, embreex, trimesh and Open3D, where installed.

All go from NumPy arrays to NumPy arrays, in the layout that each of them takes. They take turns, round after
round, so that what slows the machine for a while slows all of them; medians are reported. With `--reports` answers
are counted in place: `reports` has faults that others' users found, `exact` what is right, `peers` who is asked.
"""

from .command import main
from .engines import (
    ENGINES,
    KINDS,
    NEEDS,
    POINT_TASKS,
    RAY_TASKS,
    TASKS,
    Answer,
    Embreex,
    Engine,
    Kdray,
    Open3D,
    Trimesh,
)
from .measure import Row, different, engines_for, measure, run
from .report import plot
from .workload import BUILT_IN, CLASSES, Mesh, Query, make_points, make_rays, read, room, sphere

__all__ = [
    "BUILT_IN",
    "CLASSES",
    "ENGINES",
    "KINDS",
    "NEEDS",
    "POINT_TASKS",
    "RAY_TASKS",
    "TASKS",
    "Answer",
    "Embreex",
    "Engine",
    "Kdray",
    "Mesh",
    "Open3D",
    "Query",
    "Row",
    "Trimesh",
    "different",
    "engines_for",
    "main",
    "make_points",
    "make_rays",
    "measure",
    "plot",
    "read",
    "room",
    "run",
    "sphere",
]
