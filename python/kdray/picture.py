"""Pictures: arrays that can be saved and that notebooks show."""

from __future__ import annotations

import copy
import os
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from ._calls import tell_in_one_line
from .errors import InputError


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
        if isinstance(pixels, Picture):
            channels = dict(pixels.channels) if channels is None else channels
            warnings = list(pixels.warnings) if warnings is None else warnings
        picture.channels = channels or {}
        picture.warnings = warnings or []
        return picture

    def __array_finalize__(self, of: Any) -> None:
        # A view of a picture may show all of it as it is; what has other memory is another one, unless a method below
        # says that it isn't.
        is_view = isinstance(of, Picture) and self.ctypes.data == of.ctypes.data
        self._channels = of.channels if is_view else {}
        self._laid = of._laid if is_view else ()
        self.warnings = getattr(of, "warnings", [])

    def __array_wrap__(self, array: Any, *context: Any) -> Any:
        made = super().__array_wrap__(array, *context)  # what arithmetic has made
        return self._lend(made) if made.ndim > 0 else made[()]  # one number is a number

    def copy(self, order: Any = "C") -> Picture:
        """A copy, with copies of the channels."""
        made = super().copy(order)
        made.channels = {name: values.copy() for name, values in self.channels.items()}
        return made

    def astype(self, *args: Any, **named: Any) -> Any:
        """Numbers of another type, with the channels."""
        return self._lend(super().astype(*args, **named))

    def __copy__(self) -> Picture:
        return self.copy()

    def __deepcopy__(self, memo: Any) -> Picture:
        made = self.copy()
        made.channels = copy.deepcopy(made.channels, memo)
        return made

    def _lend(self, made: Any) -> Any:
        if isinstance(made, Picture) and made is not self and made.shape == self.shape:
            made.channels = dict(self.channels)
        return made

    @property
    def channels(self) -> dict[str, npt.NDArray[np.float32]]:
        """What was asked for beside the colour, by name, each height x width.

        What is cut out of a picture, or turned, has none: they would no longer fit.
        """
        return self._channels if (self.shape, self.strides) == self._laid else {}

    @channels.setter
    def channels(self, channels: dict[str, npt.NDArray[np.float32]]) -> None:
        self._channels, self._laid = channels, (self.shape, self.strides)

    def __reduce__(self) -> Any:
        return Picture, (np.asarray(self), self.channels, self.warnings)

    def save(
        self,
        path: str | os.PathLike[str],
        *,
        gamma: float | None = None,
        exposure: float = 0.0,
        bits: int = 8,
        within: tuple[int, int, int, int] | None = None,
    ) -> list[str]:
        """Writes a .png (2^exposure times the colours in sRGB, or v^(1/gamma); 8 or 16 bits) or a .exr (linear, all
        channels).

        `within` = (x, y, width, height): it is a part of a picture of that size and begins there, as `render`'s crop
        has it, which an EXR says by its windows. Returns the files' names: beside a PNG each channel has one of its
        own. Files are written whole or not at all. Raises InputError where that can't be done.
        """
        pixels = self._pixels()
        for name, values in self.channels.items():
            if np.shape(values) != pixels.shape[:2]:
                raise InputError(f"the channel {name} is {np.shape(values)}, and the picture {pixels.shape[:2]}")
        channels = [(name, np.ascontiguousarray(values, np.float32)) for name, values in self.channels.items()]
        return list(_core.write_picture(os.fsdecode(path), pixels, channels, gamma or 0.0, exposure, bits, within))

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


tell_in_one_line(Picture, but={"copy", "astype"})
