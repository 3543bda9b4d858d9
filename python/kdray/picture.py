"""Pictures: arrays that can be saved and that notebooks show."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core


class Picture(np.ndarray[Any, np.dtype[np.float32]]):
    """Linear RGB, float32, height x width x 3, row 0 at the top; an array like any other.

    `warnings` says what went wrong on the way; the picture is right all the same.
    """

    warnings: list[str]
    _channels: dict[str, npt.NDArray[np.float32]]
    _laid: tuple[Any, ...]  # the shape and strides that the channels fit

    def __new__(
        cls,
        pixels: npt.ArrayLike,
        channels: dict[str, npt.NDArray[np.float32]] | None = None,
        warnings: list[str] | None = None,
    ) -> Picture:
        """Pixels (height, width, 3), linear; for `save` of whatever a program has computed."""
        picture = np.asarray(pixels, dtype=np.float32).view(cls)
        picture._channels = channels or {}
        picture._laid = (picture.shape, picture.strides)
        picture.warnings = warnings or []
        return picture

    def __array_finalize__(self, of: Any) -> None:
        self._channels = getattr(of, "_channels", {})
        self._laid = getattr(of, "_laid", ())
        self.warnings = getattr(of, "warnings", [])

    @property
    def channels(self) -> dict[str, npt.NDArray[np.float32]]:
        """What was asked for beside the colour, by name, each height x width.

        What is cut out of a picture, or turned, has none: they would no longer fit.
        """
        return self._channels if (self.shape, self.strides) == self._laid else {}

    def __reduce__(self) -> Any:
        return Picture, (np.asarray(self), self.channels, self.warnings)

    def save(self, path: str | os.PathLike[str], *, gamma: float | None = None, bits: int = 8) -> list[str]:
        """Writes a .png (sRGB, or v^(1/gamma); 8 or 16 bits) or a .exr (linear, with all channels).

        Returns the files' names: beside a PNG each channel has one of its own. Files are written whole or not at
        all. Raises InputError where that can't be done.
        """
        channels = [(name, np.ascontiguousarray(values)) for name, values in self.channels.items()]
        return list(_core.write_picture(os.fspath(path), self._pixels(), channels, gamma or 0.0, bits))

    def _pixels(self) -> npt.NDArray[np.float32]:
        if self.ndim != 3 or self.shape[2] != 3:
            raise ValueError(f"a picture is height x width x 3, not {self.shape}")
        if self.size == 0:
            raise ValueError(f"a picture of {self.shape[1]} x {self.shape[0]} has no pixels")
        return np.ascontiguousarray(np.asarray(self))

    def _repr_png_(self) -> bytes | None:
        if self.ndim != 3 or self.shape[2] != 3 or self.size == 0:
            return None
        return bytes(_core.encode_png(self._pixels()))
