"""kdray as what tells pyvista which points lie inside of a surface.

>>> import pyvista
>>> import kdray.pyvista
>>> kdray.pyvista.install()
>>> int(pyvista.Plane().select_interior_points(pyvista.Sphere(radius=0.12))["selected_points"].sum())
5

`install` replaces ``select_interior_points`` and ``select_enclosed_points`` of every dataset. Without it:
``kdray.pyvista.select_interior_points(dataset, surface)``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pyvista

from .scene import Scene

_METHODS = ("signed_distance", "cell_locator")
_before: tuple[Any, Any] | None = None  # pyvista's own filters


def select_interior_points(
    dataset: Any,
    surface: Any,
    *,
    method: str = "signed_distance",
    inside_out: bool = False,
    check_surface: bool = True,
    locator_tolerance: float | None = None,
) -> Any:
    """A shallow copy of the dataset with the point array "selected_points": which of them lie inside of a surface.

    Arguments are those of `pyvista.DataSetFilters.select_interior_points`; there is no tolerance, so
    `locator_tolerance` means nothing. A point is inside of an odd number of closed surfaces (`kdray.Scene.contains`);
    one on the surface counts as inside, and with `inside_out` as outside, where the method is "signed_distance".
    RuntimeError where `check_surface` finds an open edge.
    """
    if method not in _METHODS:
        raise ValueError(f"method is one of {', '.join(_METHODS)}, not {method!r}")
    if locator_tolerance is not None and method == "signed_distance":
        raise ValueError("locator_tolerance cannot be used with the signed_distance method.")
    inside = _inside(dataset, surface, check_surface, inside_out, with_surface=method == "signed_distance")
    out = dataset.copy(deep=False)
    out["selected_points"] = inside
    out.set_active_scalars("selected_points")
    return out


def select_enclosed_points(
    dataset: Any,
    surface: Any,
    tolerance: float = 0.001,
    inside_out: bool = False,
    check_surface: bool = True,
    progress_bar: bool = False,
) -> Any:
    """A copy of the dataset with the point array "SelectedPoints", uint8: 1 inside of the surface.

    Arguments are those of `pyvista.DataSetFilters.select_enclosed_points`, which pyvista replaces by
    `select_interior_points`; there is no tolerance, and nothing to wait for.
    """
    out = dataset.copy()
    out["SelectedPoints"] = _inside(dataset, surface, check_surface, inside_out, with_surface=False).astype(np.uint8)
    return out


def install() -> None:
    """Makes both filters of all datasets kdray's. Doing it twice does nothing more."""
    global _before
    if _before is not None:
        return
    filters: Any = pyvista.DataSetFilters
    _before = (
        getattr(filters, "select_interior_points", None),  # since pyvista 0.47
        getattr(filters, "select_enclosed_points", None),  # until 0.50
    )
    filters.select_interior_points = select_interior_points
    filters.select_enclosed_points = select_enclosed_points


def uninstall() -> None:
    """Gives datasets pyvista's own filters again."""
    global _before
    if _before is None:
        return
    for name, own in zip(("select_interior_points", "select_enclosed_points"), _before, strict=True):
        if own is None:
            delattr(pyvista.DataSetFilters, name)
        else:
            setattr(pyvista.DataSetFilters, name, own)
    _before = None


def _inside(
    dataset: Any, surface: Any, check_surface: bool, inside_out: bool, with_surface: bool
) -> npt.NDArray[np.bool_]:
    if not isinstance(surface, pyvista.PolyData):
        raise TypeError("surface: a pyvista.PolyData is wanted")
    if check_surface and surface.n_open_edges > 0:
        raise RuntimeError("the surface is not closed; repair it, or pass check_surface=False")
    points = np.asarray(dataset.points, np.float64)
    triangles = surface.triangulate().faces.reshape(-1, 4)[:, 1:]
    if len(triangles) == 0 or len(points) == 0:
        return np.full(len(points), inside_out)
    scene = Scene(geometry="auto")
    scene.add_mesh(np.asarray(surface.points), triangles)
    selected = scene.contains(points) != inside_out
    if with_surface:
        selected |= scene.closest_point(points, radius=0.0, fields=("distance",)).distance == 0
    return np.asarray(selected)
