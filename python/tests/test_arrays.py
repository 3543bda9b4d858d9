"""Arrays in whatever form people have them: each answer is that of contiguous copies, and nothing is read beyond."""

import ctypes
import mmap

import numpy as np
import pytest

import kdray
import kdray.trimesh
from kdray import _arrays

FLOATS = ("f4", "f8", ">f4", ">f8", "f2", "g", "i2", "i8", ">i4")
INDICES = ("u1", "i2", "i4", "u4", "i8", "u8", ">i4", ">u8")
MASKS = ("u4", ">u4", "i4", "u8", "u1")
HITS = ("t", "geometry", "primitive", "u", "v", "normal", "point", "instance")


def before_a_wall(size: int) -> np.ndarray:
    """So many bytes, behind which lies a page that can't be read: who does so is ended by the system."""
    page = mmap.PAGESIZE
    length = -(-size // page) * page
    memory = np.frombuffer(mmap.mmap(-1, length + page), np.uint8)
    libc = ctypes.CDLL(None, use_errno=True)
    assert libc.mprotect(ctypes.c_void_p(memory.ctypes.data + length), page, 0) == 0
    return memory[length - size : length]


class Layouts:
    """Arrays by chance: of some type, byte order and strides, before a wall."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng(seed)

    def pick(self, choices):
        return choices[self.rng.integers(len(choices))]

    def floats(self, shape, least, most, width=(3,), share=True) -> np.ndarray:
        return self.laid(self.rng.uniform(least, most, (*shape, *width)), self.pick(FLOATS), len(width), share)

    def laid(self, values: np.ndarray, dtype: str, n_wide: int, share: bool = True) -> np.ndarray:
        """An array of that shape; not of those values, where its elements share memory."""
        kind = np.dtype(dtype)
        shape, item = values.shape, kind.itemsize
        rows, wide = shape[: values.ndim - n_wide], shape[values.ndim - n_wide :]
        step = self.pick((item, item, item, -item, 2 * item, item + 1))
        strides = [step * int(np.prod(wide[k + 1 :])) for k in range(n_wide)]
        if n_wide == 2 and self.rng.random() < 0.3:
            strides = [step, step * wide[0]]
        row = item + sum((extent - 1) * abs(s) for extent, s in zip(wide, strides, strict=True))
        between = [row, row + item, row + 1, 3 * row + 5]
        if share and abs(step) == item:
            between += [0, 0, item]
        stride = self.pick(between)
        by_row = [stride * int(np.prod(rows[k + 1 :])) * self.pick((1, 1, 1, -1)) for k in range(len(rows))]
        strides = by_row + strides
        reach = [(extent - 1) * s for extent, s in zip(shape, strides, strict=True)]
        memory = before_a_wall(item + sum(abs(r) for r in reach))
        array = np.ndarray(shape, kind, memory, -sum(min(r, 0) for r in reach), strides)
        array[...] = values.astype(kind)
        if self.rng.random() < 0.2:
            array.flags.writeable = False
        return array


def plain(array, shape=None):
    """A contiguous copy, of a type that kdray reads."""
    if array is None:
        return None
    kind = array.dtype.newbyteorder("=")
    if kind.kind == "f":
        kind = np.dtype(np.float32 if kind.itemsize < 8 else np.float64)
    full = array if shape is None else np.broadcast_to(array, shape)
    return np.array(full, kind, order="C")


def scenes(layouts: Layouts, n: int) -> tuple[kdray.Scene, kdray.Scene]:
    """The same scene of such arrays, and of copies."""
    vertices, moved = layouts.floats((n + 2,), -3, 3, share=False), layouts.floats((n + 2,), -3, 3)
    normals = layouts.floats((n + 2,), 1, 3)
    uv = layouts.floats((n + 2,), 0, 1, (2,))
    triangles = layouts.laid(layouts.rng.integers(0, min(n + 2, 100), (n, 3)), layouts.pick(INDICES), 1)
    centers, apexes, axes = (layouts.floats((n,), least, least + 4) for least in (-4, 5, 1))
    radii, thin = layouts.floats((n,), 3, 5, ()), layouts.floats((n,), 1, 2.5, ())
    frames = np.tile(np.eye(4), (n, 1, 1))
    frames[:, :3, 3] = layouts.rng.integers(-9, 9, (n, 3))
    transforms = layouts.laid(frames[:, : layouts.pick((3, 4))], layouts.pick(FLOATS), 2, False)
    materials = layouts.laid(np.zeros(n), layouts.pick(MASKS), 0)
    made = []
    for form in (lambda array: array, plain):
        scene = kdray.Scene()
        mesh = scene.add_mesh(form(vertices), form(triangles), normals=form(normals), uv=form(uv))
        scene.add_spheres(form(centers), form(radii), mask=1)
        scene.add_cones(form(centers), form(radii), form(apexes), form(thin), mask=2)
        scene.add_discs(form(centers), form(axes), form(radii))
        scene.add_tori(form(centers), form(axes), form(radii), form(thin))
        ball = scene.add_spheres(form(centers), form(thin), prototype=True)
        balls = scene.add_instances(ball, form(transforms), materials=form(materials))
        scene.update_vertices(mesh, form(moved), form(normals))
        scene.update_transforms(balls, form(transforms))
        made.append(scene)
    return made[0], made[1]


def assert_same(mine, theirs) -> None:
    assert mine.dtype == theirs.dtype and mine.shape == theirs.shape
    np.testing.assert_array_equal(mine, theirs)


@pytest.mark.parametrize("seed", range(40))
def test_the_form_of_arrays_changes_no_answer(seed):
    layouts = Layouts(seed)
    mine, theirs = scenes(layouts, int(layouts.rng.integers(1, 30)))
    np.testing.assert_array_equal(mine.bounds, theirs.bounds)
    rows, columns = (int(x) for x in layouts.rng.integers(1, 9, 2))
    shapes = ((rows, columns), (rows, columns), (rows, 1), (1, columns), (columns,), (1,), ())

    def rays(least, most, width=(3,)):
        return layouts.floats(layouts.pick(shapes), least, most, width)

    given = [layouts.floats((rows, columns), -9, 9), rays(-2, 2), rays(0, 0.1, ()), rays(2, 60, ())]
    bits = layouts.laid(layouts.rng.integers(0, 4, layouts.pick(shapes)), layouts.pick(MASKS), 0)
    given.append(layouts.pick((None, bits)))
    alike = [
        plain(a, None if a is None else (rows, columns, *a.shape[a.ndim - w :]))
        for a, w in zip(given, (1, 1, 0, 0, 0), strict=True)
    ]
    hits, expected = (s.closest_hit(*args, fields=HITS) for s, args in ((mine, given), (theirs, alike)))
    for name in HITS:
        assert_same(getattr(hits, name), getattr(expected, name))
    assert_same(mine.closest_hit(*given).point, theirs.closest_hit(*alike).point)
    assert_same(mine.any_hit(*given), theirs.any_hit(*alike))
    assert_same(mine.count_hits(*given), theirs.count_hits(*alike))
    all_mine, all_theirs = mine.all_hits(*given), theirs.all_hits(*alike)
    for name in all_mine.__slots__:
        assert_same(getattr(all_mine, name), getattr(all_theirs, name))
    for scene in (mine, theirs):
        scene.enable(scene.geometries[-1].id, False)  # instances, which points can't be asked of
    points = layouts.floats((rows, columns), -5, 5)
    nearest, expected = mine.closest_point(points), theirs.closest_point(plain(points))
    for name in nearest._names:
        assert_same(getattr(nearest, name), getattr(expected, name))
    assert_same(mine.signed_distance(points), theirs.signed_distance(plain(points)))
    assert_same(mine.contains(points), theirs.contains(plain(points)))


@pytest.mark.parametrize("seed", range(12))
def test_the_look_alikes_too(seed, ball_mesh):
    layouts = Layouts(seed)
    vertices, triangles = ball_mesh
    mine, theirs = kdray.RaycastingScene(), kdray.RaycastingScene()
    laid = [
        layouts.laid(vertices, layouts.pick(("f4", ">f8", "g")), 1, False),
        layouts.laid(triangles, layouts.pick(INDICES[2:]), 1, False),
    ]
    mine.add_triangles(*laid)
    theirs.add_triangles(*map(plain, laid))
    rays = layouts.laid(layouts.rng.uniform(-2, 2, (3, 5, 6)), layouts.pick(FLOATS[:6]), 1)
    points = layouts.laid(layouts.rng.uniform(-2, 2, (3, 5, 3)), layouts.pick(FLOATS[:6]), 1)
    for name in ("cast_rays", "list_intersections"):
        found, expected = getattr(mine, name)(rays), getattr(theirs, name)(plain(rays))
        for key, values in found.items():
            assert_same(values, expected[key])
    for name in ("test_occlusions", "count_intersections"):
        assert_same(getattr(mine, name)(rays), getattr(theirs, name)(plain(rays)))
    found, expected = mine.compute_closest_points(points), theirs.compute_closest_points(plain(points))
    for key, values in found.items():
        assert_same(values, expected[key])
    for name in ("compute_distance", "compute_signed_distance", "compute_occupancy"):
        assert_same(getattr(mine, name)(points), getattr(theirs, name)(plain(points)))
    ray = kdray.trimesh.RayMeshIntersector(kdray.trimesh.trimesh.Trimesh(vertices, triangles, process=False))
    origins, directions = (layouts.floats((15,), -2, 2) for _ in range(2))
    as_doubles = [plain(a).astype(np.float64) for a in (origins, directions)]
    assert_same(ray.intersects_first(origins, directions), ray.intersects_first(*as_doubles))
    assert_same(ray.intersects_location(origins, directions)[0], ray.intersects_location(*as_doubles)[0])
    assert_same(ray.contains_points(origins), ray.contains_points(as_doubles[0]))


def test_one_row_for_all_is_not_copied(ball):
    eye, down = np.array([0, 0, 5.0]), np.array([0, 0, -1.0])
    n = 10**6
    origins, directions = np.broadcast_to(eye, (n, 3)), np.broadcast_to(down, (n, 3))
    rays = _arrays.RayArrays(origins, directions, np.broadcast_to(np.float64(0.5), n), np.inf, None)
    assert rays.origins.strides == (0, 8) and np.shares_memory(rays.origins, eye)
    assert rays.t_min is not None and rays.t_min.strides == (0,)
    assert (ball.closest_hit(origins, directions).t == 4).all()
    assert (ball.signed_distance(origins) == ball.signed_distance(eye)).all()
    scene = kdray.Scene()
    scene.add_spheres(np.broadcast_to(eye, (9, 3)), np.broadcast_to(1.0, 9))
    np.testing.assert_array_equal(scene.bounds, [[-1, -1, 4], [1, 1, 6]])


@pytest.mark.parametrize("t", [5, 5.0, 0.1, -2, 1e-30, float("nan")])
def test_a_number_that_limits_float32_rays_is_one_of_theirs(t):
    rows = np.zeros((4, 3), np.float32)
    rays = _arrays.RayArrays(rows, rows, t, t, None)
    assert rays.t_min is not None and rays.t_min.dtype == np.float32
    assert rays.t_max is not None and rays.t_max.dtype == np.float32
    assert _arrays.RayArrays(rows.astype(np.float64), rows, t, t, None).t_min.dtype == np.float64
    assert _arrays.RayArrays(rows, rows, np.float64(t), t, None).t_min.dtype == np.float64


@pytest.mark.parametrize("t", [1e-50, -1e-50, 1e39, 1e305, -1e200])
def test_a_limit_that_no_float32_holds_stays_a_double(t):
    rows = np.zeros((4, 3), np.float32)
    assert _arrays.RayArrays(rows, rows, t, 1, None).t_min.tolist() == [t]


def test_rays_are_broadcast_as_numpy_does(ball, rng):
    origins, directions = rng.normal(size=(5, 1, 3)) * 0.4, rng.normal(size=(1, 4, 3))
    t_max, mask = rng.uniform(0.1, 1, (4,)), np.array([[1], [1], [0], [1], [1]])
    full = [np.broadcast_to(a, (5, 4, 3)).copy() for a in (origins, directions)]
    limits = {"t_max": np.broadcast_to(t_max, (5, 4)).copy(), "mask": np.broadcast_to(mask, (5, 4)).copy()}
    hits = ball.closest_hit(origins, directions, t_max=t_max, mask=mask)
    expected = ball.closest_hit(*full, **limits)
    assert hits.t.shape == (5, 4) and 0 < hits.hit.sum() < 20
    np.testing.assert_array_equal(hits.t, expected.t)
    np.testing.assert_array_equal(hits.point, expected.point)
    assert ball.any_hit(np.zeros((1, 1, 3)), np.ones((5, 3))).shape == (1, 5)
    assert ball.any_hit(np.zeros((0, 1, 3)), np.ones((4, 3))).shape == (0, 4)
    with pytest.raises(kdray.InputError, match=r"directions has shape \(5,\) where origins has \(4,\)"):
        ball.any_hit(np.zeros((4, 3)), np.ones((5, 3)))
    with pytest.raises(kdray.InputError, match=r"t_max has shape \(2,\) where origins has \(5, 1\)"):
        ball.any_hit(origins, directions, t_max=[1, 2])


def test_fields_of_structures(ball, rng):
    packed = np.zeros(50, np.dtype([("label", "u1"), ("o", "f4", 3), ("d", ">f8", 3)]))
    packed["o"], packed["d"] = rng.normal(size=(2, 50, 3)) * 2
    expected = ball.closest_hit(packed["o"].copy(), packed["d"].astype(float))
    np.testing.assert_array_equal(ball.closest_hit(packed["o"], packed["d"]).t, expected.t)


def test_strides_beyond_32_bits(ball):
    stride = 2**31 + 8
    try:
        flags = mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS | 0x4000  # MAP_NORESERVE
        memory = mmap.mmap(-1, 3 * stride + 4096, flags=flags)
    except OSError as why:
        pytest.skip(f"no 6 GiB of addresses: {why}")
    rays = np.ndarray((4, 3), np.float64, memory, strides=(stride, 8))
    rays[:] = [[0, 0, 5], [0, 0, 6], [0, 0, 7], [0, 0, 8]]
    assert ball.closest_hit(rays, [0, 0, -1]).t.tolist() == [4, 5, 6, 7]
    assert ball.closest_hit(rays[::-1], [0, 0, -1]).t.tolist() == [7, 6, 5, 4]


def test_what_is_masked_is_refused(ball, ball_mesh):
    rows = np.ma.array([[0, 0, 5.0]] * 2, mask=[[0, 0, 0], [0, 0, 1]])
    whole = np.ma.array([[0, 0, 5.0]] * 2)
    down = [0, 0, -1]
    assert ball.closest_hit(whole, down).t.tolist() == [4, 4] and ball.signed_distance(whole).tolist() == [4, 4]
    for name, ask in {
        "origins": lambda: ball.closest_hit(rows, down),
        "directions": lambda: ball.any_hit(down, rows),
        "t_max": lambda: ball.count_hits(whole, down, t_max=rows[:, 2]),
        "mask": lambda: ball.all_hits(whole, down, mask=np.ma.array([1, 1], mask=[0, 1])),
        "points": lambda: ball.contains(rows),
        "vertices": lambda: ball.add_mesh(rows, [[0, 1, 1]]),
        "triangles": lambda: ball.add_mesh(ball_mesh[0], np.ma.array([[0, 1, 2]], mask=[[0, 0, 1]])),
        "centers": lambda: ball.add_spheres(list(rows), 1),
        "radii": lambda: ball.add_spheres(whole, rows[:, 2]),
        "rays": lambda: kdray.RaycastingScene().cast_rays(np.ma.hstack([rows, rows])),
    }.items():
        with pytest.raises(kdray.InputError, match=f"^{name}: elements of it are masked"):
            ask()


@pytest.mark.filterwarnings("ignore:the matrix subclass")
def test_subclasses_are_what_they_hold(ball):
    eye = np.asmatrix([[0, 0, 5.0], [0, 0, 6.0]])
    assert ball.closest_hit(eye, [0, 0, -1], t_max=np.asarray([9, 4.5])).t.tolist() == [4, np.inf]
    assert ball.any_hit([0, 0, 5.0], [0, 0, -1], t_max=np.asmatrix([[3.0, 4.5]])).tolist() == [[False, True]]
