from collections.abc import Callable, Sequence
from typing import Any

from numpy.typing import NDArray

def end_calls() -> None: ...
def css_color(arg: str, /) -> list[float]: ...
def shape_fields(arg: str, /) -> list[tuple[str, bool, bool]]: ...

class Scene:
    def __init__(self) -> None: ...
    @staticmethod
    def load(
        file: str,
        smooth_degrees: float | None,
        time: float | None = None,
        animation: str = "",
        asset_root: str = "",
        instances: str = "auto",
    ) -> Scene: ...
    def add_mesh(
        self,
        vertices: NDArray[Any] | None,
        triangles: NDArray[Any] | None,
        normals: NDArray[Any] | None,
        texcoords: NDArray[Any] | None,
        name: str,
        mask: int,
        material: int,
        prototype: bool,
    ) -> int: ...
    def add_shapes(
        self, kind: str, arrays: Sequence[NDArray[Any] | None], name: str, mask: int, material: int, prototype: bool
    ) -> int: ...
    def add_instances(
        self, prototype: int, transforms: NDArray[Any] | None, materials: NDArray[Any] | None, name: str, mask: int
    ) -> int: ...
    def update_transforms(self, id: int, transforms: NDArray[Any] | None) -> None: ...
    def update_vertices(self, id: int, vertices: NDArray[Any] | None, normals: NDArray[Any] | None) -> None: ...
    def remove(self, arg: int, /) -> None: ...
    def enable(self, arg0: int, arg1: bool, /) -> None: ...
    def set_mask(self, arg0: int, arg1: int, /) -> None: ...
    def geometries(self) -> list[int]: ...
    def info(self, arg: int, /) -> tuple[Any, ...]: ...
    def mesh(self, arg: int, /) -> tuple[Any, ...]: ...
    def parts(self, arg: int, /) -> list[tuple[str, int, int]]: ...
    def instance_parts(self, arg: int, /) -> list[tuple[str, int, int]]: ...
    def materials(self) -> list[tuple[str, int]]: ...
    def materials_of(
        self,
        geometry: NDArray[Any] | None,
        primitive: NDArray[Any] | None,
        instance: NDArray[Any] | None,
        out: NDArray[Any] | None,
    ) -> None: ...
    def primitives(self) -> int: ...
    def bounds(self) -> tuple[list[float], list[float]] | None: ...
    def warnings(self) -> list[str]: ...
    def add_light(
        self,
        arg0: str,
        arg1: Sequence[float],
        arg2: Sequence[float],
        arg3: Sequence[float],
        arg4: Sequence[float],
        arg5: float,
        arg6: float,
        arg7: float,
        arg8: Sequence[float],
        arg9: Sequence[float],
        arg10: Sequence[float],
        arg11: float,
        /,
    ) -> None: ...
    def set_camera(
        self,
        arg0: Sequence[float],
        arg1: Sequence[float],
        arg2: Sequence[float],
        arg3: float,
        arg4: float,
        arg5: float,
        arg6: float,
        arg7: float,
        /,
    ) -> None: ...
    def set_background(self, arg: Sequence[float], /) -> None: ...
    def set_gradient(
        self, arg0: Sequence[float], arg1: Sequence[Sequence[float]], arg2: Sequence[float], /
    ) -> None: ...
    def set_environment(self, arg0: str, arg1: Sequence[float], arg2: float, arg3: float, /) -> None: ...
    def set_ambient(self, arg: Sequence[float], /) -> None: ...
    def add_picture(self, pixels: NDArray[Any]) -> int: ...
    def add_picture_file(self, file: str) -> int: ...
    def add_material(
        self,
        arg0: Sequence[float],
        arg1: Sequence[float],
        arg2: Sequence[float],
        arg3: Sequence[float],
        arg4: Sequence[float],
        arg5: Sequence[float],
        arg6: float,
        arg7: float,
        arg8: Sequence[int],
        arg9: str,
        arg10: Sequence[float],
        /,
    ) -> int: ...
    def commit(self, quality: str, device: str, compute_units: int, binary_form: bool, geometry: str) -> bool: ...
    def closest(
        self,
        origins: NDArray[Any] | None,
        directions: NDArray[Any] | None,
        t_min: NDArray[Any] | None,
        t_max: NDArray[Any] | None,
        masks: NDArray[Any] | None,
        strict: bool,
        t: NDArray[Any] | None,
        geometry: NDArray[Any] | None,
        primitive: NDArray[Any] | None,
        u: NDArray[Any] | None,
        v: NDArray[Any] | None,
        normal: NDArray[Any] | None,
        point: NDArray[Any] | None,
        instance: NDArray[Any] | None = None,
    ) -> int: ...
    def any(
        self,
        origins: NDArray[Any] | None,
        directions: NDArray[Any] | None,
        t_min: NDArray[Any] | None,
        t_max: NDArray[Any] | None,
        masks: NDArray[Any] | None,
        strict: bool,
        out: NDArray[Any] | None,
    ) -> int: ...
    def count(
        self,
        origins: NDArray[Any] | None,
        directions: NDArray[Any] | None,
        t_min: NDArray[Any] | None,
        t_max: NDArray[Any] | None,
        masks: NDArray[Any] | None,
        strict: bool,
        out: NDArray[Any] | None,
    ) -> int: ...
    def all(
        self,
        origins: NDArray[Any] | None,
        directions: NDArray[Any] | None,
        t_min: NDArray[Any] | None,
        t_max: NDArray[Any] | None,
        masks: NDArray[Any] | None,
        strict: bool,
        max_hits: int,
    ) -> tuple[Any, ...]: ...
    def closest_points(
        self,
        points: NDArray[Any] | None,
        radius: float,
        strict: bool,
        distance: NDArray[Any] | None,
        point: NDArray[Any] | None,
        geometry: NDArray[Any] | None,
        primitive: NDArray[Any] | None,
        u: NDArray[Any] | None,
        v: NDArray[Any] | None,
        instance: NDArray[Any] | None = None,
    ) -> int: ...
    def inside(self, arg0: NDArray[Any] | None, arg1: bool, arg2: NDArray[Any] | None, /) -> int: ...
    def signed_distance(
        self, arg0: NDArray[Any] | None, arg1: float, arg2: bool, arg3: NDArray[Any] | None, /
    ) -> int: ...
    def render(
        self,
        camera: Sequence[float] | None,
        width: int,
        height: int,
        samples: int,
        depth: int,
        min_weight: float,
        adaptive: float,
        mode: str,
        precision: str,
        channels: Sequence[str],
        progress: Callable[[float], None] | None,
        look: str,
        crop: Sequence[int] | None,
    ) -> tuple[Any, ...]: ...

def write_picture(
    file: str,
    pixels: NDArray[Any],
    channels: Sequence[tuple[str, NDArray[Any]]],
    gamma: float,
    exposure: float,
    bits: int,
    within: Sequence[int] | None,
) -> list[str]: ...
def encode_png(arg: NDArray[Any], /) -> bytes: ...
def devices() -> tuple[Any, ...]: ...
def keep_programs() -> None: ...
def require_device(arg: str, /) -> None: ...
def refuse_after_fork() -> None: ...
def set_texture_cache(arg: int, /) -> None: ...
def program_folder() -> str: ...

class Page:
    def __init__(
        self,
        scene: Scene,
        name: str,
        camera: Sequence[float] | None,
        device: str,
        compute_units: int,
        port: int,
        framed: bool,
        look: str,
    ) -> None: ...
    def address(self) -> str: ...
    def update(self, scene: Scene) -> None: ...
    def close(self) -> None: ...
