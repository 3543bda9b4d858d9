"""Pictures of whatever was given: the bytes that kdray._core reads in place."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import errors
from ._arrays import Array, ArrayLike, as_array


def in_bytes_of_color(values: Any) -> Any:
    """What an image of Pillow's shows: its bytes may be numbers of a palette, or colours of another kind."""
    mode = getattr(values, "mode", None)
    if mode in ("P", "PA"):
        return values.convert("RGBA" if mode == "PA" or "transparency" in values.info else "RGB")
    if mode in ("CMYK", "HSV", "YCbCr", "LAB", "RGBX", "RGBa", "La"):
        return values.convert({"RGBa": "RGBA", "La": "LA"}.get(mode, "RGB"))
    return values


def pixels_of(values: ArrayLike, name: str = "picture") -> Array:
    """H x W x 1 to 4 bytes, pixels side by side, of an array of that shape or of H x W (grey)."""
    array = as_array(in_bytes_of_color(values), name)
    if array.dtype != np.uint8:
        raise errors.InputError(f"{name}: bytes are wanted (uint8, codes of sRGB), not {array.dtype}")
    if array.ndim == 2:
        array = array[:, :, np.newaxis]
    if array.ndim != 3 or not 1 <= array.shape[2] <= 4:
        raise errors.InputError(f"{name}: the shape is to be (h, w), or (h, w, 1 to 4), not {array.shape}")
    if array.size == 0:
        raise errors.InputError(f"{name}: it has no pixels: {array.shape[0]} rows of {array.shape[1]}")
    if max(array.shape[:2]) > 2**31 - 1:  # what a word holds; kdray itself allows far less
        raise errors.InputError(f"{name}: its sides of {array.shape[1]} x {array.shape[0]} are too long")
    return np.ascontiguousarray(array)
