"""Rays of cameras and scanners, for `Scene.closest_hit` and its like."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from . import errors
from ._arrays import ArrayLike, vectors
from .looks import Camera

Rays = tuple[npt.NDArray[Any], npt.NDArray[Any]]


def pinhole_rays(camera: Camera, width: int, height: int, *, dtype: npt.DTypeLike = np.float32) -> Rays:
    """Origins and directions of the rays through the pixels' centres, each of shape (height, width, 3).

    They are the eye rays of `Scene.render` with that camera (`hither` is for a t_min): row 0 is the top. Directions of
    a perspective camera reach the plane at distance 1, so that t is the depth along the view, where the picture's
    channel "depth" is the distance from the eye; an orthographic one's are of length 1. In float32 an origin far from 0
    is rounded (at 5e6 by a quarter): take ``dtype=np.float64`` there.
    """
    if width < 1 or height < 1:
        raise errors.UsageError(f"a picture of {width} x {height} has no pixels")
    camera.numbers()  # checks them
    origin, forward, right, up = _frame(camera)
    x = (np.arange(width) + 0.5) / width * 2 - 1
    y = 1 - (np.arange(height) + 0.5) / height * 2
    half_height = math.tan(math.radians(camera.fov) / 2) if not camera.ortho_width else 0.0
    half_width = camera.ortho_width / 2 if camera.ortho_width else half_height * width / height
    if camera.ortho_width:
        half_height = half_width * height / width
    offsets = x[None, :, None] * half_width * right + y[:, None, None] * half_height * up
    same = np.zeros((height, width, 3))
    if camera.ortho_width:
        return (origin + offsets).astype(dtype), (same + forward).astype(dtype)
    return (origin + same).astype(dtype), (forward + offsets).astype(dtype)


def _frame(camera: Camera) -> tuple[npt.NDArray[np.float64], ...]:
    origin = np.asarray(camera.origin, np.float64)
    forward = np.asarray(camera.target, np.float64) - origin
    right = np.cross(forward, np.asarray(camera.up, np.float64))
    if not (np.isfinite(forward).all() and np.linalg.norm(forward) > 0 and np.linalg.norm(right) > 0):
        raise errors.UsageError("the camera looks nowhere, or straight along its own up")
    forward /= np.linalg.norm(forward)
    right /= np.linalg.norm(right)
    return origin, forward, right, np.cross(right, forward)


def lidar_rays(
    positions: ArrayLike,
    elevations: ArrayLike,
    *,
    steps: int = 1024,
    azimuths: ArrayLike | None = None,
    rotations: ArrayLike | None = None,
    dtype: npt.DTypeLike = np.float64,
) -> Rays:
    """A spinning scanner's sweep: rays of unit length, each array of shape (positions, elevations, azimuths, 3).

    `positions` (n, 3) or (3,): where it stands. `elevations`: of its lasers, in degrees above the horizon.
    `azimuths` in degrees, or `steps` of them all around, counterclockwise from x seen from above (z is up).
    `rotations` (n, 3, 3) or (3, 3): how it is held, from its own frame to the world's.
    """
    place, _ = vectors(positions, "positions")
    if azimuths is None:
        if not (steps >= 1 and steps // 1 == steps):
            raise errors.UsageError(f"steps is a whole number from 1 on, not {steps}")
        azimuths = np.arange(steps) * (360.0 / steps)
    a = np.radians(np.asarray(azimuths, np.float64).reshape(-1))
    e = np.radians(np.asarray(elevations, np.float64).reshape(-1))
    own = np.stack(
        [
            np.cos(e)[:, None] * np.cos(a),
            np.cos(e)[:, None] * np.sin(a),
            np.broadcast_to(np.sin(e)[:, None], (len(e), len(a))),
        ],
        axis=-1,
    )
    n = len(place)
    if rotations is None:
        directions = np.broadcast_to(own, (n, *own.shape))
    else:
        turns = np.asarray(rotations, np.float64)
        if turns.shape not in ((3, 3), (n, 3, 3)):
            raise errors.InputError(f"rotations: the shape is to be (3, 3) or ({n}, 3, 3), not {turns.shape}")
        directions = np.einsum("nij,eaj->neai", np.broadcast_to(turns, (n, 3, 3)), own)
    origins = np.broadcast_to(place[:, None, None, :], directions.shape)
    return origins.astype(dtype), directions.astype(dtype)
