"""Cameras, lights and materials: what pictures need beside shapes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from . import _core
from .errors import UsageError

Vector = Sequence[float]
# Three linear values, or text as CSS has it: "skyblue", "#fff", "#87ceeb".
Color = Sequence[float] | str

_NO_PICTURE = 2**32 - 1


def linear(color: Color) -> tuple[float, ...]:
    """The three linear values of a colour."""
    return tuple(_core.css_color(color) if isinstance(color, str) else color)


@dataclass(frozen=True)
class Camera:
    """Where a picture is seen from.

    `fov` is of the picture's full height, in degrees. `ortho_width` above 0 makes the camera
    orthographic: it is the picture's width in the scene's units. Nothing nearer than `hither` is seen.
    `aperture` above 0 is the diameter of a thin lens: what is not in focus is blurred; `focus` is how far
    off, along the view, what is in focus is (0: as far as `target`).
    """

    origin: Vector = (0.0, 0.0, 5.0)
    target: Vector = (0.0, 0.0, 0.0)
    up: Vector = (0.0, 1.0, 0.0)
    fov: float = 45.0
    ortho_width: float = 0.0
    hither: float = 0.0
    aperture: float = 0.0
    focus: float = 0.0

    def numbers(self) -> list[float]:
        """Its fourteen numbers, for kdray._core."""
        lens = (self.fov, self.ortho_width, self.hither, self.aperture, self.focus)
        if not len(self.origin) == len(self.target) == len(self.up) == 3:
            raise UsageError("a camera's origin, target and up have three coordinates each")
        numbers = [float(x) for x in (*self.origin, *self.target, *self.up, *lens)]
        if not self.ortho_width >= 0:
            raise UsageError(f"a camera's ortho_width is 0 or more, not {self.ortho_width}")
        if not self.ortho_width and not 0 < self.fov < 180:
            raise UsageError(f"a camera's fov is above 0 and below 180 degrees, not {self.fov}")
        return numbers


@dataclass(frozen=True)
class Light:
    """A light: "point", "directional", "spot", "rectangle", "sphere" or "disc".

    `direction` is the way it travels. `attenuation` (a, b, c) divides by ``a + b*d + c*d*d`` at
    distance d. `inner` and `outer` are a spot's half angles in degrees, full light inside of the inner one.
    The last three kinds have an area and throw soft shadows: each sample of a pixel sees another place of it.
    `position` is the middle; a rectangle has the edges `across` and `down`, a disc `normal` and `radius`, a
    sphere `radius`.
    """

    kind: str = "point"
    position: Vector = (0.0, 0.0, 0.0)
    direction: Vector = (0.0, 0.0, -1.0)
    color: Color = (1.0, 1.0, 1.0)
    attenuation: Vector = (1.0, 0.0, 0.0)
    range: float = math.inf
    inner: float = 0.0
    outer: float = 45.0
    across: Vector = (0.0, 0.0, 0.0)
    down: Vector = (0.0, 0.0, 0.0)
    normal: Vector = (0.0, -1.0, 0.0)
    radius: float = 0.0


@dataclass(frozen=True)
class Material:
    """Whitted's terms, linear RGB or as CSS has it ("skyblue"), each with its colour multiplied in.

    `shine` is the exponent of the highlight, `index` that of refraction. The default is a matt light grey.

    Pictures are numbers of `Scene.add_picture`, and are seen on meshes that have `uv`. `picture` is multiplied by
    the ambient and diffuse terms and by what goes through; `alpha` says what its alpha means: nothing ("opaque"),
    that nothing is there where it is below a half ("mask"), or the share of light that isn't let through
    ("blend"). `emission_picture` is multiplied by `emission`, or by white where that is black.
    `normal_picture` bends normals as glTF's do: x to the right, y up, z out of the surface.
    `metal_picture` says by its green how rough and by its blue how metallic a place is, times the factors
    `roughness` and `metallic` (0 to 1). With it all terms but the emission follow from these and from the base
    colour, which is `diffuse` times `picture`, as glTF's do. The red of `occlusion_picture` is the share of
    ambient light that gets there; with `occlusion` below 1 that much of it counts.
    """

    diffuse: Color = (0.8, 0.8, 0.8)
    ambient: Color | None = None  # a tenth of `diffuse`
    emission: Color = (0.0, 0.0, 0.0)
    specular: Color = (0.0, 0.0, 0.0)
    reflect: Color = (0.0, 0.0, 0.0)
    transmit: Color = (0.0, 0.0, 0.0)
    shine: float = 1.0
    index: float = 1.0
    picture: int | None = None
    normal_picture: int | None = None
    emission_picture: int | None = None
    alpha: str = "opaque"
    metal_picture: int | None = None
    metallic: float = 1.0
    roughness: float = 1.0
    occlusion_picture: int | None = None
    occlusion: float = 1.0

    def picture_numbers(self) -> list[int]:
        """Its five pictures, for kdray._core; 2**32 - 1 is none."""
        surface = (self.picture, self.normal_picture, self.emission_picture)
        numbers = (*surface, self.metal_picture, self.occlusion_picture)
        for number in numbers:
            if number is not None and not 0 <= number < _NO_PICTURE:
                raise UsageError(f"a material's picture is a number of Scene.add_picture, not {number!r}")
        return [_NO_PICTURE if number is None else int(number) for number in numbers]
