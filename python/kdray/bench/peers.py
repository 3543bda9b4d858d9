"""Who is asked about the faults of `reports`: kdray and what else is installed, each by its usual calls.

Not what `engines` times: here any layout will do, and a peer that knows no batches is asked ray by ray. A peer takes a
mesh, and has a method for each question that it answers: `closest` (t, inf where nothing is hit), `occlusion`, `count`
(crossings ahead), `inside` and `signed_distance` (negative inside).
"""

from __future__ import annotations

import importlib
import importlib.metadata
from typing import Any, no_type_check

import numpy as np

from .. import __version__
from ..scene import Scene
from .workload import Array


def _doubles(array: Array) -> Array:
    return np.ascontiguousarray(array, np.float64)


def _floats(*arrays: Array) -> list[Array]:
    return [np.ascontiguousarray(a, np.float32) for a in arrays]


class Peer:
    """What is asked; `needs` are the modules that have to be installed, `package` has the version."""

    name = package = ""
    needs: tuple[str, ...] = ()

    def __init__(self, vertices: Array, triangles: Array) -> None:
        self.vertices, self.triangles = vertices, np.ascontiguousarray(triangles, np.int32)

    @classmethod
    def version(cls) -> str:
        """Its package's."""
        return importlib.metadata.version(cls.package)


class Rays(Peer):
    """A peer with no question of its own for whether a ray hits anything."""

    def closest(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        raise NotImplementedError

    def occlusion(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return np.isfinite(self.closest(origins, directions))


class Kdray(Peer):
    """kdray; of doubles where floats can't hold the vertices."""

    name = "kdray"

    def __init__(self, vertices: Array, triangles: Array) -> None:
        super().__init__(vertices, triangles)
        fit = np.array_equal(vertices, np.asarray(vertices, np.float32))
        self.scene = Scene(geometry="float" if fit else "double")
        self.scene.add_mesh(vertices, triangles)

    @classmethod
    def version(cls) -> str:  # noqa: D102
        return __version__

    def closest(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return np.asarray(self.scene.closest_hit(origins, directions, fields=("t",)).t)

    def occlusion(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return self.scene.any_hit(origins, directions)

    def count(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return self.scene.count_hits(origins, directions)

    def inside(self, points: Array) -> Array:  # noqa: D102
        return self.scene.contains(points)

    def signed_distance(self, points: Array) -> Array:  # noqa: D102
        return self.scene.signed_distance(points)


class Trimesh(Peer):
    """trimesh with its own rays; repeated hits are merged, as its documentation wants for counting."""

    name = package = "trimesh"
    needs: tuple[str, ...] = ("trimesh", "rtree", "scipy")
    embree = False

    def __init__(self, vertices: Array, triangles: Array) -> None:
        super().__init__(vertices, triangles)
        made: Any = importlib.import_module("trimesh")
        self.mesh = made.Trimesh(vertices, triangles, process=False, use_embree=self.embree)
        self.distance = made.proximity.signed_distance

    def closest(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        places, ray, _ = self.mesh.ray.intersects_location(origins, directions, multiple_hits=False)
        t = np.full(len(origins), np.inf)
        along = directions[ray]
        t[ray] = np.einsum("ij,ij->i", places - origins[ray], along) / np.einsum("ij,ij->i", along, along)
        return t

    def occlusion(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return np.asarray(self.mesh.ray.intersects_any(origins, directions))

    def count(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        _, ray, _ = self.mesh.ray.intersects_location(origins, directions)
        return np.bincount(ray, minlength=len(origins))

    def inside(self, points: Array) -> Array:  # noqa: D102
        return np.asarray(self.mesh.contains(points))

    def signed_distance(self, points: Array) -> Array:  # noqa: D102
        return -np.asarray(self.distance(self.mesh, points))


class TrimeshEmbree(Trimesh):
    """trimesh on top of embreex."""

    name = "trimesh+embreex"
    needs = (*Trimesh.needs, "embreex")
    embree = True


class TrimeshKdray(Trimesh):
    """trimesh on top of kdray."""

    name = "trimesh+kdray"

    def __init__(self, vertices: Array, triangles: Array) -> None:
        super().__init__(vertices, triangles)
        self.mesh.ray = importlib.import_module("kdray.trimesh").RayMeshIntersector(self.mesh)


class Embreex(Peer):
    """embreex by itself."""

    name = package = "embreex"
    needs = ("embreex",)

    def __init__(self, vertices: Array, triangles: Array) -> None:
        super().__init__(vertices, triangles)
        self.scene = importlib.import_module("embreex.rtcore_scene").EmbreeScene()
        made: Any = importlib.import_module("embreex.mesh_construction")
        made.TriangleMesh(self.scene, *_floats(vertices), self.triangles)

    def closest(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        found = self.scene.run(*_floats(origins, directions), output=True)
        return np.where(found["primID"] >= 0, found["tfar"], np.inf)

    def occlusion(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return np.asarray(self.scene.run(*_floats(origins, directions), query="OCCLUDED") != -1)


class Open3D(Peer):
    """Open3D's RaycastingScene: Embree's robust mode, and one ray for parity."""

    name = "Open3D"
    needs = ("open3d",)

    def __init__(self, vertices: Array, triangles: Array) -> None:
        super().__init__(vertices, triangles)
        open3d: Any = importlib.import_module("open3d")
        self.tensor = open3d.core.Tensor.from_numpy
        self.scene = open3d.t.geometry.RaycastingScene()
        self.scene.add_triangles(self.tensor(*_floats(vertices)), self.tensor(self.triangles.astype(np.uint32)))

    @classmethod
    def version(cls) -> str:
        """Of whichever of its packages is there."""
        return str(importlib.import_module("open3d").__version__)

    def _rays(self, origins: Array, directions: Array) -> Any:
        return self.tensor(np.concatenate(_floats(origins, directions), axis=1))

    def closest(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return np.asarray(self.scene.cast_rays(self._rays(origins, directions))["t_hit"].numpy())

    def occlusion(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return np.asarray(self.scene.test_occlusions(self._rays(origins, directions)).numpy())

    def count(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return np.asarray(self.scene.count_intersections(self._rays(origins, directions)).numpy())

    def inside(self, points: Array) -> Array:  # noqa: D102
        return np.asarray(self.scene.compute_occupancy(self.tensor(*_floats(points))).numpy(), np.bool_)

    def signed_distance(self, points: Array) -> Array:  # noqa: D102
        return np.asarray(self.scene.compute_signed_distance(self.tensor(*_floats(points))).numpy())


class Mitsuba(Peer):
    """Mitsuba's scene, with LLVM where there is one."""

    name = package = "mitsuba"
    needs = ("mitsuba",)
    robust = False

    def __init__(self, vertices: Array, triangles: Array) -> None:
        super().__init__(vertices, triangles)
        self.mi: Any = importlib.import_module("mitsuba")
        self.mi.set_variant("llvm_ad_rgb")
        mesh = self.mi.Mesh("mesh", len(vertices), len(triangles))
        parameters = self.mi.traverse(mesh)
        parameters["vertex_positions"] = _floats(vertices)[0].ravel()
        parameters["faces"] = self.triangles.astype(np.uint32).ravel()
        parameters.update()
        self.scene = self.mi.load_dict({"type": "scene", "mesh": mesh, "embree_use_robust_intersections": self.robust})

    def _rays(self, origins: Array, directions: Array) -> Any:
        o, d = _floats(np.transpose(origins), np.transpose(directions))
        return self.mi.Ray3f(self.mi.Point3f(o), self.mi.Vector3f(d))

    def closest(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return np.array(self.scene.ray_intersect_preliminary(self._rays(origins, directions), coherent=False).t)

    def occlusion(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return np.array(self.scene.ray_test(self._rays(origins, directions)))


class MitsubaRobust(Mitsuba):
    """Mitsuba with Embree's robust mode, which a scene has to ask for."""

    name = "mitsuba robust"
    robust = True


class Libigl(Rays):
    """libigl: `ray_mesh_intersect` of each ray, and `signed_distance` by its default."""

    name = package = "libigl"
    needs = ("igl",)

    def __init__(self, vertices: Array, triangles: Array) -> None:
        super().__init__(vertices, triangles)
        self.igl: Any = importlib.import_module("igl")
        self.mesh = np.ascontiguousarray(vertices, np.float64), np.ascontiguousarray(triangles, np.int64)

    def _hits(self, origins: Array, directions: Array) -> list[list[float]]:
        rays = _doubles(origins), _doubles(directions)
        found = [self.igl.ray_mesh_intersect(o, d, *self.mesh) for o, d in zip(*rays, strict=True)]
        return [[hit[1] for hit in hits or ()] for hits in found]

    def closest(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return np.array([min(hits, default=np.inf) for hits in self._hits(origins, directions)])

    def count(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return np.array([len(hits) for hits in self._hits(origins, directions)])

    def inside(self, points: Array) -> Array:  # noqa: D102
        return self.signed_distance(points) < 0

    def signed_distance(self, points: Array) -> Array:  # noqa: D102
        return np.asarray(self.igl.signed_distance(_doubles(points), *self.mesh)[0])


class Vtk(Rays):
    """VTK by way of pyvista."""

    name = package = "pyvista"
    needs = ("pyvista",)

    def __init__(self, vertices: Array, triangles: Array) -> None:
        super().__init__(vertices, triangles)
        self.pyvista: Any = importlib.import_module("pyvista")
        faces = np.column_stack([np.full(len(triangles), 3), triangles])
        self.mesh = self.pyvista.PolyData(_doubles(vertices), faces.ravel())
        self.middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
        self.size = float(np.linalg.norm(np.ptp(vertices, axis=0)))

    def _places(self, origin: Array, direction: Array) -> Array:
        far = (np.linalg.norm(self.middle - origin) + self.size) / np.linalg.norm(direction)
        end = origin + far * direction
        if hasattr(self.mesh, "intersect_with_line"):  # as of 0.49
            places, _ = self.mesh.intersect_with_line(origin, end, deduplicate_points=True)
        else:
            places, _ = self.mesh.ray_trace(origin, end)
        return np.reshape(places, (-1, 3))

    def closest(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        found = np.full(len(origins), np.inf)
        for i, (o, d) in enumerate(zip(_doubles(origins), _doubles(directions), strict=True)):
            found[i] = min((self._places(o, d) - o) @ d / (d @ d), default=np.inf)
        return found

    def count(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        rays = _doubles(origins), _doubles(directions)
        return np.array([len(self._places(o, d)) for o, d in zip(*rays, strict=True)])

    def inside(self, points: Array) -> Array:  # noqa: D102
        cloud = self.pyvista.PolyData(_doubles(points))
        return np.asarray(cloud.select_interior_points(self.mesh)["selected_points"], np.bool_)

    def signed_distance(self, points: Array) -> Array:  # noqa: D102
        cloud = self.pyvista.PolyData(_doubles(points))
        return np.asarray(cloud.compute_implicit_distance(self.mesh)["implicit_distance"])


class PointCloudUtils(Rays):
    """point-cloud-utils: Embree for rays, fast winding numbers for signs."""

    name = package = "point-cloud-utils"
    needs = ("point_cloud_utils",)

    def __init__(self, vertices: Array, triangles: Array) -> None:
        super().__init__(vertices, triangles)
        self.pcu: Any = importlib.import_module("point_cloud_utils")

    def closest(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        mesh = _doubles(self.vertices), self.triangles
        face, _, t = self.pcu.ray_mesh_intersection(*mesh, _doubles(origins), _doubles(directions))
        return np.where(face >= 0, t, np.inf)

    def inside(self, points: Array) -> Array:  # noqa: D102
        return self.signed_distance(points) < 0

    def signed_distance(self, points: Array) -> Array:  # noqa: D102
        mesh = _doubles(self.vertices), self.triangles
        return np.asarray(self.pcu.signed_distance_to_mesh(_doubles(points), *mesh)[0])


class Fcpw(Rays):
    """fcpw with its vectorised tree."""

    name = package = "fcpw"
    needs = ("fcpw",)

    def __init__(self, vertices: Array, triangles: Array) -> None:
        super().__init__(vertices, triangles)
        self.fcpw: Any = importlib.import_module("fcpw")
        self.scene = self.fcpw.scene_3D()
        self.scene.set_object_count(1)
        self.scene.set_object_vertices(np.asfortranarray(vertices, np.float32), 0)
        self.scene.set_object_triangles(np.asfortranarray(self.triangles), 0)
        self.scene.build(self.fcpw.aggregate_type.bvh_surface_area, True)

    def _hits(self, origins: Array, directions: Array, every: bool) -> list[list[float]]:
        found = []
        for o, d in zip(*_floats(origins, directions), strict=True):
            hits = self.fcpw.interaction_3D_list()
            number = self.scene.intersect(self.fcpw.ray_3D(o, d), hits, False, every)
            found.append([hit.d for hit in list(hits)[:number]])
        return found

    def closest(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return np.array([min(hits, default=np.inf) for hits in self._hits(origins, directions, False)])

    def count(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return np.array([len(hits) for hits in self._hits(origins, directions, True)])

    def inside(self, points: Array) -> Array:  # noqa: D102
        return np.array([self.scene.contains(p) for p in _floats(points)[0]])


class Warp(Rays):
    """NVIDIA's warp on the CPU: `inside` by parity, signs of distances by normals."""

    name = "warp"
    package = "warp-lang"
    needs = ("warp",)
    kernels: Any = None

    def __init__(self, vertices: Array, triangles: Array) -> None:
        super().__init__(vertices, triangles)
        wp: Any = importlib.import_module("warp")
        wp.config.quiet = True
        self.warp = wp
        places = wp.array(_floats(vertices)[0], dtype=wp.vec3, device="cpu")
        self.mesh = wp.Mesh(places, wp.array(self.triangles.ravel(), dtype=int, device="cpu"))
        if Warp.kernels is None:
            Warp.kernels = _warp_kernels(wp)

    def _ask(self, kernel: int, *arrays: Array) -> tuple[Array, Array]:
        wp = self.warp
        given = [wp.array(a, dtype=wp.vec3, device="cpu") for a in _floats(*arrays)]
        found = [wp.zeros(len(arrays[0]), dtype=kind, device="cpu") for kind in (float, int)]
        wp.launch(self.kernels[kernel], len(arrays[0]), [self.mesh.id, *given, *found], device="cpu")
        return found[0].numpy(), found[1].numpy()

    def closest(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        t = self._ask(0, origins, directions)[0]
        return np.where(t < 0, np.inf, t)

    def count(self, origins: Array, directions: Array) -> Array:  # noqa: D102
        return self._ask(0, origins, directions)[1]

    def inside(self, points: Array) -> Array:  # noqa: D102
        return self._ask(1, points)[1] < 0

    def signed_distance(self, points: Array) -> Array:  # noqa: D102
        return self._ask(1, points)[0]


@no_type_check
def _warp_kernels(wp: Any) -> Any:
    def rays(mesh, origin, direction, t, count):
        i = wp.tid()
        hit = wp.mesh_query_ray(mesh, origin[i], direction[i], 1.0e30)
        t[i] = wp.where(hit.result, hit.t, -1.0)
        count[i] = wp.mesh_query_ray_count_intersections(mesh, origin[i], direction[i], -1)

    def points(mesh, point, distance, side):
        i = wp.tid()
        near = wp.mesh_query_point_sign_normal(mesh, point[i], 1.0e30)
        place = wp.mesh_eval_position(mesh, near.face, near.u, near.v)
        distance[i] = near.sign * wp.length(point[i] - place)
        side[i] = int(wp.mesh_query_point_sign_parity(mesh, point[i], 1.0e30).sign)

    vectors, floats, whole = (wp.array(dtype=kind) for kind in (wp.vec3, float, int))
    rays.__annotations__ = dict(mesh=wp.uint64, origin=vectors, direction=vectors, t=floats, count=whole)
    points.__annotations__ = dict(mesh=wp.uint64, point=vectors, distance=floats, side=whole)
    return wp.kernel(rays), wp.kernel(points)


class Ncollpyde(Peer):
    """ncollpyde: three rays and a vote."""

    name = package = "ncollpyde"
    needs = ("ncollpyde",)

    def __init__(self, vertices: Array, triangles: Array) -> None:
        super().__init__(vertices, triangles)
        self.volume = importlib.import_module("ncollpyde").Volume(vertices, triangles)

    def inside(self, points: Array) -> Array:  # noqa: D102
        return np.asarray(self.volume.contains(points))

    def signed_distance(self, points: Array) -> Array:  # noqa: D102
        return np.asarray(self.volume.distance(points))


PEERS: tuple[type[Peer], ...] = (
    Kdray,
    TrimeshKdray,
    Trimesh,
    TrimeshEmbree,
    Embreex,
    Open3D,
    Mitsuba,
    MitsubaRobust,
    Libigl,
    Vtk,
    PointCloudUtils,
    Fcpw,
    Warp,
    Ncollpyde,
)
