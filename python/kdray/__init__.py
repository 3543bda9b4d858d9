"""kdray: exact and fast ray queries over triangles and shapes (spheres, cones, tori and others), and Whitted pictures.

>>> import kdray
>>> scene = kdray.Scene()
>>> ball = scene.add_spheres([[0, 0, 0]], [1])
>>> scene.closest_hit([[0, 0, 5]], [[0, 0, -1]]).t
array([4.])

Scenes hold geometries and answer questions (`Scene`); `load` reads files; `Camera`, `Light` and `Material` are for
pictures. `kdray.trimesh` makes kdray the ray engine of trimesh, `kdray.RaycastingScene` is Open3D's class by that name.
"""

from importlib.metadata import PackageNotFoundError as _NotFound
from importlib.metadata import version as _version

from .devices import Device, devices
from .errors import (
    CancelledError,
    Error,
    InputError,
    InternalError,
    NoDeviceError,
    OutOfMemoryError,
    UsageError,
)
from .hits import AllHits, ClosestPoints, Hits
from .looks import Camera, Light, Material
from .open3d import RaycastingScene
from .picture import Picture
from .rays import lidar_rays, pinhole_rays
from .scene import Geometry, MaterialInfo, Part, Scene, load, set_texture_cache
from .view import View

try:
    __version__ = _version("kdray")
except _NotFound:  # from a build folder
    __version__ = "0"

__all__ = [
    "AllHits",
    "Camera",
    "CancelledError",
    "ClosestPoints",
    "Device",
    "Error",
    "Geometry",
    "Hits",
    "InputError",
    "InternalError",
    "Light",
    "Material",
    "MaterialInfo",
    "NoDeviceError",
    "OutOfMemoryError",
    "Part",
    "Picture",
    "RaycastingScene",
    "Scene",
    "UsageError",
    "View",
    "devices",
    "lidar_rays",
    "load",
    "pinhole_rays",
    "set_texture_cache",
]
