"""What rays and points are told, held against plain NumPy."""

import pickle

import numpy as np
import pytest

import kdray
from kdray.bench.exact import Exact
from kdray.bench.meshes import ball as small_ball

FLOATS = (np.float32, np.float64)


def brute_force(vertices, triangles, origins, directions):
    """t of the nearest triangle in double, infinity where there is none (Moeller and Trumbore)."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    e1, e2 = b - a, c - a
    best = np.full(len(origins), np.inf)
    for i, (o, d) in enumerate(zip(origins, directions, strict=True)):
        p = np.cross(d, e2)
        det = np.einsum("ij,ij->i", e1, p)
        with np.errstate(divide="ignore", invalid="ignore"):
            s = o - a
            u = np.einsum("ij,ij->i", s, p) / det
            q = np.cross(s, e1)
            v = q @ d / det
            t = np.einsum("ij,ij->i", e2, q) / det
        t[~((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0))] = np.inf
        best[i] = t.min()
    return best


@pytest.mark.parametrize("dtype", FLOATS)
def test_closest_hit_is_brute_forces(ball, ball_mesh, rng, dtype):
    vertices, triangles = ball_mesh
    o = (3 * rng.normal(size=(400, 3))).astype(dtype)
    d = (rng.normal(size=(400, 3)) - o / 3).astype(dtype)
    hits = ball.closest_hit(o, d)
    expected = brute_force(vertices, triangles, o.astype(float), d.astype(float))
    assert hits.t.dtype == dtype
    np.testing.assert_array_equal(np.isinf(hits.t), np.isinf(expected))
    finite = np.isfinite(expected)
    assert finite.any() and not finite.all()
    np.testing.assert_allclose(hits.t[finite], expected[finite], rtol=3e-6)


def test_a_hit_has_all_its_fields(ball, ball_mesh, rng):
    vertices, triangles = ball_mesh
    o = 3 * rng.normal(size=(500, 3))
    d = -o + 0.3 * rng.normal(size=o.shape)
    hits = ball.closest_hit(o, d)
    hit = hits.hit
    assert hits.fields == ("t", "geometry", "primitive", "u", "v", "normal")
    at_once = ball.closest_hit(o, d, fields=("point",))
    assert at_once.fields == ("point",)
    np.testing.assert_array_equal(at_once.point, hits.point)
    assert (hits.geometry[hit] == 0).all() and (hits.geometry[~hit] == -1).all()
    assert (hits.primitive[~hit] == -1).all() and hits.primitive.dtype == np.int32
    a, b, c = (vertices[triangles[hits.primitive[hit], k]] for k in range(3))
    u, v = hits.u[hit, None], hits.v[hit, None]
    np.testing.assert_allclose((1 - u - v) * a + u * b + v * c, hits.point[hit], atol=2e-6)
    np.testing.assert_allclose(o[hit] + hits.t[hit, None] * d[hit], hits.point[hit], atol=1e-12)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    np.testing.assert_allclose(hits.normal[hit], normal, atol=1e-4)
    assert (hits.normal[~hit] == 0).all() and np.isinf(hits.point[~hit]).all()


@pytest.mark.parametrize("shape", [(), (1,), (7,), (3, 5), (3, 3), (2, 1, 4), (0,), (4, 0, 2)])
def test_results_have_the_shape_of_the_rays(ball, shape):
    o = np.zeros((*shape, 3)) + [0, 0, 5]
    hits = ball.closest_hit(o, [0, 0, -1])
    for name in (*hits.fields, "point"):
        wide = (*shape, 3) if name in ("normal", "point") else shape
        assert getattr(hits, name).shape == wide, name
    assert ball.any_hit(o, [0, 0, -1]).shape == shape
    assert ball.count_hits(o, [0, 0, -1]).shape == shape
    assert ball.contains(o).shape == shape
    assert ball.closest_point(o).point.shape == (*shape, 3)
    assert (hits.t == 4).all() and (ball.count_hits(o, [0, 0, -1]) == 2).all()


def test_layout_and_type_do_not_matter(ball, rng):
    o = rng.normal(size=(64, 3)) * 2
    d = rng.normal(size=(64, 3))
    expected = ball.closest_hit(o, d).t
    both = np.concatenate([o, d], axis=1)
    wide = np.zeros((128, 3))
    wide[::2] = o
    readonly = o.copy()
    readonly.flags.writeable = False
    for origins, directions in (
        (both[:, :3], both[:, 3:]),
        (np.asfortranarray(o), np.asfortranarray(d)),
        (wide[::2], d),
        (o[::-1][::-1], d),
        (readonly, d),
        (o.astype(">f8"), d),
        (o.tolist(), d.tolist()),
        (memoryview(o), d),
        (OnlyDLPack(o), OnlyDLPack(d)),
    ):
        np.testing.assert_array_equal(ball.closest_hit(origins, directions).t, expected)
    np.testing.assert_array_equal(ball.closest_hit(o[::-1], d[::-1]).t, expected[::-1])
    half = ball.closest_hit(o.astype(np.float16), d.astype(np.float16))
    assert half.t.dtype == np.float32


class OnlyDLPack:
    """What arrays of other libraries look like."""

    def __init__(self, array):
        self._array = array

    def __dlpack__(self, **named):
        return self._array.__dlpack__(**named)

    def __dlpack_device__(self):
        return self._array.__dlpack_device__()


def test_bounds_of_rays(ball):
    o, d = [0, 0, 5.0], [0, 0, -1.0]
    assert ball.closest_hit(o, d, t_min=4.5).t == 6
    assert np.isinf(ball.closest_hit(o, d, t_max=3.5).t)
    assert ball.closest_hit([o, o], d, t_min=[0, 4.5]).t.tolist() == [4, 6]
    assert ball.any_hit([o, o], d, t_max=np.array([3.5, 4.5], np.float32)).tolist() == [False, True]
    assert ball.count_hits([o] * 3, d, t_min=[0, 4.5, 6.5]).tolist() == [2, 1, 0]


def test_masks_of_rays_and_geometries():
    scene = kdray.Scene()
    near = scene.add_spheres([0, 0, 0], 1, mask=1)
    far = scene.add_spheres([0, 0, -5], 1, mask=2)
    o, d = [[0, 0, 5.0]] * 4, [0, 0, -1.0]
    assert scene.closest_hit(o, d, mask=[1, 2, 3, 4]).geometry.tolist() == [near, far, near, -1]
    assert scene.count_hits(o, d, mask=np.array([1, 2, 3, 4], np.uint32)).tolist() == [2, 2, 4, 0]
    scene.set_mask(near, 4)
    assert scene.closest_hit(o, d, mask=[1, 2, 3, 4]).geometry.tolist() == [-1, far, far, near]


def test_all_hits_are_sorted_and_counted(ball, rng):
    o = 3 * rng.normal(size=(300, 3))
    d = rng.normal(size=(300, 3)) - o
    hits = ball.all_hits(o, d)
    counts = ball.count_hits(o, d)
    assert hits.splits.dtype == np.int64 and hits.splits[-1] == len(hits)
    np.testing.assert_array_equal(hits.counts, counts)
    outside = ~ball.contains(o)
    assert outside.any() and (counts[outside] % 2 == 0).all() and (counts[~outside] % 2 == 1).all()
    first = counts > 0
    np.testing.assert_allclose(hits.t[hits.splits[:-1][first]], ball.closest_hit(o, d).t[first], rtol=2e-6)  # floats
    same_ray = hits.ray[1:] == hits.ray[:-1]
    assert (np.diff(hits.t)[same_ray] >= 0).all()
    two = ball.all_hits(o, d, max_hits=1)
    np.testing.assert_array_equal(two.counts, np.minimum(counts, 1))
    np.testing.assert_array_equal(two.more, counts > 1)


def test_points(ball, ball_mesh, rng):
    vertices, _ = ball_mesh
    points = rng.normal(size=(200, 3))
    distance = ball.closest_point(points).distance
    nearest = np.linalg.norm(points[:, None] - vertices, axis=2).min(axis=1)
    assert (distance <= nearest + 2e-7).all()  # vertices are floats about the centre
    inside = ball.contains(points)
    np.testing.assert_array_equal(ball.signed_distance(points), np.where(inside, -distance, distance))
    radius = np.linalg.norm(points, axis=1)
    np.testing.assert_array_equal(inside[radius > 1], False)
    np.testing.assert_array_equal(inside[radius < 0.98], True)
    assert np.isinf(ball.closest_point([9, 9, 9], radius=1).distance)


def test_utm_coordinates_keep_a_millimetre():
    corner = np.array([500000.123, 5400000.456, 123.789])
    box = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * 0.001
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1]]
    faces += [[2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
    scene = kdray.Scene()
    scene.add_mesh(corner + box, faces)
    o = corner + [0.0003, 0.0004, 10000]
    hits = scene.all_hits(o, [0, 0, -1])
    np.testing.assert_allclose(hits.t, [9999.999, 10000], rtol=0, atol=2e-9)


def test_out_is_written_in_place(ball, rng):
    o, d = rng.normal(size=(2, 50, 3)).astype(np.float32) * 2
    hits = ball.closest_hit(o, d)
    again = ball.closest_hit(o[:1], d[:1], fields=("t",))
    with pytest.raises(kdray.InputError, match=r"out\.t"):
        ball.closest_hit(o, d, out=again)
    t = hits.t
    expected, point = t.copy(), hits.point
    other = ball.closest_hit(-o, -d, out=hits)
    assert not np.array_equal(other.point, point)
    t[:] = 0
    assert ball.closest_hit(o, d, out=hits) is hits
    np.testing.assert_array_equal(t, expected)
    np.testing.assert_array_equal(hits.point, point)
    found = np.zeros(50, bool)
    assert ball.any_hit(o, d, out=found) is found
    np.testing.assert_array_equal(found, hits.hit)
    for wrong in (np.zeros(50), np.zeros(49, bool), np.zeros(100, bool)[::2], found.tolist()):
        with pytest.raises(kdray.InputError, match="out"):
            ball.any_hit(o, d, out=wrong)


def test_fields_that_are_not_asked_for_are_not_there(ball):
    hits = ball.closest_hit([0, 0, 5], [0, 0, -1], fields=("t", "normal"))
    assert hits.fields == ("t", "normal")
    with pytest.raises(AttributeError, match="fields="):
        _ = hits.u
    with pytest.raises(kdray.UsageError, match="there is no field 'colour'"):
        ball.closest_hit([0, 0, 5], [0, 0, -1], fields=("colour",))


def test_rays_that_mean_nothing(ball):
    o = [[0, 0, 5], [np.nan, 0, 5], [0, 0, 5], [np.inf, 0, 0]]
    d = [[0, 0, -1], [0, 0, -1], [0, 0, 0], [0, 0, -1]]
    assert ball.closest_hit(o, d).hit.tolist() == [True, False, False, False]
    assert ball.count_hits(o, d).tolist() == [2, 0, 0, 0]
    with pytest.raises(kdray.InputError, match="ray 1"):
        ball.closest_hit(o, d, strict=True)
    nowhere = [[0, 0, np.nan], [np.inf, 0, 0], [0, -np.inf, 0]]
    assert ball.contains(nowhere).tolist() == [False, False, False]
    np.testing.assert_array_equal(ball.signed_distance(nowhere), [np.nan, np.inf, np.inf])


def test_doubles_are_on_the_side_that_they_say():
    scene = kdray.Scene()
    corners = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)])
    faces = [[0, 2, 3], [0, 3, 1], [4, 5, 7], [4, 7, 6], [0, 1, 5], [0, 5, 4]]
    faces += [[2, 6, 7], [2, 7, 3], [0, 4, 6], [0, 6, 2], [1, 3, 7], [1, 7, 5]]
    scene.add_mesh(corners, faces)
    points = np.array([[1 + 3e-8, 0.3, 0.2], [1 - 3e-8, 0.3, 0.2]])
    assert scene.contains(points).tolist() == [False, True]
    np.testing.assert_allclose(scene.signed_distance(points), [3e-8, -3e-8], atol=1e-15)
    assert scene.count_hits([0.1, 0.2, 1 - 1e-8], [1, 0.01, 0]) == 1
    assert scene.all_hits([[0.1, 0.2, 0.3]], [[1, 0.1, 0.05]]).t == pytest.approx([0.9], abs=1e-15)


def test_an_empty_scene_has_nothing_to_hit():
    scene = kdray.Scene()
    assert not scene.closest_hit([0, 0, 5], [0, 0, -1]).hit
    assert np.isinf(scene.signed_distance([0, 0, 0]))
    assert len(scene.all_hits([[0, 0, 5]], [0, 0, -1])) == 0


@pytest.mark.parametrize(
    ("origins", "directions", "named", "message"),
    [
        ([[0, 0]], [0, 0, 1], {}, r"origins: the shape is to be \(\.\.\., 3\), not \(1, 2\)"),
        ([["a", "b", "c"]], [0, 0, 1], {}, "origins: numbers are wanted"),
        ([[0, 0, 1j]], [0, 0, 1], {}, "origins: numbers are wanted"),
        ([[0, 0, 0]] * 2, [[0, 0, 1]] * 3, {}, r"directions has shape \(3,\) where origins has \(2,\)"),
        ([[0, 0, 0]] * 2, [0, 0, 1], {"t_min": [0] * 3}, r"t_min has shape \(3,\)"),
        ([[0, 0, 0]], [0, 0, 1], {"mask": [2**32]}, "mask: whole numbers of 32 bits are wanted"),
        ([[0, 0, 0]], [0, 0, 1], {"mask": [0.5]}, "mask: whole numbers of 32 bits are wanted"),
    ],
)
def test_what_is_wrong_is_named(ball, origins, directions, named, message):
    with pytest.raises(kdray.InputError, match=message):
        ball.closest_hit(origins, directions, **named)


# ---- Scenes of doubles


@pytest.fixture
def speck() -> tuple[np.ndarray, np.ndarray]:
    """A ball of a millimetre, 900 km out on a floor of 1000 km: floats have none of its corners apart."""
    vertices, triangles = small_ball(3)
    floor = [[0, 0, -1], [1e6, 0, -1], [0, 1e6, -1], [1e6, 1e6, -1]]
    vertices = np.concatenate([1e-3 * vertices + MIDDLE, floor])
    return vertices, np.concatenate([triangles, len(vertices) + np.array([[-4, -3, -1], [-4, -1, -2]])])


MIDDLE = np.array([900000.123, 900000.456, 0.789])


def scene_of(mesh, **options) -> kdray.Scene:
    scene = kdray.Scene(**options)
    scene.add_mesh(*mesh)
    return scene


def test_double_geometry_answers_exactly(speck, rng):
    scene, right = scene_of(speck, geometry="double"), Exact(*speck)
    origins = MIDDLE + 3e-3 * rng.normal(size=(150, 3))
    targets = MIDDLE + 1.1e-3 * rng.normal(size=(150, 3)) / 3**0.5
    # Beside corners, not at them: there a line may touch the ball, which counts by rules.
    targets[:70] = speck[0][rng.integers(0, len(speck[0]) - 4, 70)] + 1e-8 * rng.normal(size=(70, 3))
    rays = origins, targets - origins
    t = right.first(*rays)
    hits = scene.closest_hit(*rays, fields=("t", "u", "v", "primitive", "point"))
    assert hits.t.dtype == hits.u.dtype == hits.v.dtype == hits.point.dtype == np.float64
    np.testing.assert_array_max_ulp(hits.t, t, 1)
    a, b, c = (speck[0][speck[1][hits.primitive[hits.hit], k]] for k in range(3))
    u, v = hits.u[hits.hit, None], hits.v[hits.hit, None]
    np.testing.assert_allclose(a + u * (b - a) + v * (c - a), hits.point[hits.hit], rtol=1e-15)
    crossings = right.crossings(*rays)
    assert (hits.primitive[hits.hit] < len(speck[1]) - 2).sum() > 50 and (crossings == 0).any()
    np.testing.assert_array_equal(scene.any_hit(*rays), np.isfinite(t))
    np.testing.assert_array_equal(scene.count_hits(*rays), crossings)
    every = scene.all_hits(*rays)
    np.testing.assert_array_equal(every.counts, crossings)
    np.testing.assert_array_max_ulp(every.t[every.splits[:-1][crossings > 0]], t[crossings > 0], 1)
    ball = scene_of((speck[0][:-4], speck[1][:-2]), geometry="double")
    right = Exact(speck[0][:-4], speck[1][:-2])
    np.testing.assert_array_equal(ball.contains(targets), right.inside(targets))
    np.testing.assert_allclose(ball.signed_distance(targets), right.signed_distance(targets), rtol=1e-9, atol=1e-18)


def test_floats_lose_what_double_geometry_keeps(speck):
    ray = MIDDLE + [0, 0, 2], [0, 0, -1]
    last = len(speck[1]) - 2
    assert scene_of(speck, geometry="double").closest_hit(*ray).primitive < last
    assert scene_of(speck).closest_hit(*ray).primitive >= last


def test_double_geometry_keeps_to_the_rays_type_and_goes_with_copies(speck, tmp_path):
    scene = scene_of(speck, geometry="double")
    hits = scene.closest_hit(np.float32([9, 9, 9]), np.float32([0, 0, -1]))
    assert hits.t.dtype == hits.u.dtype == np.float32 and hits.t == 10
    assert scene.closest_point(MIDDLE).u.dtype == np.float64
    ray = MIDDLE + [0, 0, 2], [0, 0, -1]
    t = scene.closest_hit(*ray).t
    assert scene.copy().closest_hit(*ray).t == t == pickle.loads(pickle.dumps(scene)).closest_hit(*ray).t
    file = tmp_path / "speck.obj"
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in speck[0].tolist()]
    file.write_text("\n".join([*lines, *(f"f {a} {b} {c}" for a, b, c in (speck[1] + 1).tolist())]))
    assert kdray.load(file, geometry="double").closest_hit(*ray).t == t


@pytest.mark.parametrize("mask", [1.5, "all", None])
def test_masks_of_geometries_are_whole_numbers(mask):
    scene = kdray.Scene()
    with pytest.raises(kdray.InputError, match=r"mask: .* is no whole number"):
        scene.add_spheres([[0, 0, 0]], 1, mask=mask)


def test_a_cone_is_crossed_once_beside_its_tip():
    random = np.random.default_rng(8)
    scene = kdray.Scene()
    scene.add_cones([[0, 0, 0]], 1, [[0, 0, 2]], 0)
    origins = random.normal(size=(20000, 3)) * (10 ** random.uniform(-7, -3, 20000))[:, None] + [0, 0, 5]
    directions = np.tile([0, 0, -1.0], (20000, 1))
    directions[::2, :2] += random.uniform(-1e-6, 1e-6, (10000, 2))
    rays = origins.astype(np.float32), directions.astype(np.float32)
    assert np.isfinite(scene.closest_hit(*rays).t).all()
    assert (scene.count_hits(*rays) == 1).all()


@pytest.mark.parametrize("n", [500, 2**15])  # the host's alone, and the device's first
def test_float32_rays_of_double_geometry_find_what_comes_after_a_hit(ball_mesh, n):
    random = np.random.default_rng(7)
    scene = kdray.Scene(geometry="double")
    vertices, triangles = ball_mesh
    scene.add_mesh(vertices + random.uniform(-1e-9, 1e-9, vertices.shape), triangles)
    scene.add_spheres([[0.1, 0.2, 0.3]], 0.4)
    origins = random.uniform(-3, 3, (n, 3)).astype(np.float32)
    directions = (random.uniform(-0.5, 0.5, (n, 3)) - origins).astype(np.float32)
    first = scene.closest_hit(origins, directions)
    assert np.isfinite(first.t).mean() > 0.5
    assert (scene.closest_hit(origins, directions, t_min=first.t).t > first.t).all(where=np.isfinite(first.t))
    assert not scene.any_hit(origins, directions, t_max=first.t).any()


def test_double_geometry_is_that_of_shapes_as_well():
    with pytest.raises(kdray.UsageError, match='geometry is "float", "double" or "auto", not'):
        kdray.Scene(geometry="float64")
    shapes = kdray.Scene(geometry="double")
    shapes.add_spheres([[0.1, 0.2, 1e7]], 0.3)
    hit = shapes.closest_hit([0.1, 0.2, 1e7 + 5], [0, 0, -1])
    assert (hit.t, hit.normal.tolist()) == (5 - 0.3, [0, 0, 1])
    assert shapes.count_hits([0.1 + 0.3 - 1e-15, 0.2, 0], [0, 0, 1]) == 2
    assert shapes.count_hits([0.1 + 0.3 + 1e-15, 0.2, 0], [0, 0, 1]) == 0
    assert shapes.signed_distance([0.1, 0.2, 1e7 + 0.25]) == pytest.approx(-0.05, abs=1e-9)


def test_geometry_is_double_by_itself_where_vertices_are_no_floats(ball_mesh):
    def geometry_of(fill):
        scene = kdray.Scene(geometry="auto")
        fill(scene)
        return scene.geometry

    corners, triangles = ball_mesh[0].astype(np.float32).astype(np.float64), ball_mesh[1]
    assert geometry_of(lambda scene: scene.add_mesh(np.round(corners * 1024) / 1024, triangles)) == "float"
    assert geometry_of(lambda scene: scene.add_mesh(np.round(corners * 1024) / 1024 + 4096, triangles)) == "float"
    assert geometry_of(lambda scene: scene.add_mesh(corners + 1e-12, triangles)) == "double"
    assert geometry_of(lambda scene: None) == "float"

    def with_a_sphere(scene):
        scene.add_mesh(corners + 1e-12, triangles)
        scene.add_spheres([[0, 0, 0]], 1)

    def with_instances(scene):
        scene.add_instances(scene.add_mesh(corners + 1e-12, triangles, prototype=True), np.eye(4))

    moving = kdray.Scene(geometry="auto")
    mesh = moving.add_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    assert moving.geometry == "float"
    moving.update_vertices(mesh, [[0, 0, 0], [1 + 2**-40, 0, 0], [0, 1, 0]])
    assert moving.geometry == "double"
    moving.update_vertices(mesh, [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    assert moving.geometry == "float"

    assert geometry_of(with_a_sphere) == geometry_of(with_instances) == "float"
    assert kdray.Scene().geometry == "float"


def test_instances_of_doubles_are_where_their_transforms_bring_them(ball_mesh):
    placed = kdray.Scene(geometry="double")
    away = np.eye(4)
    away[:3, 3] = [1e6, 2e6, 3e6 + 1 / 3]
    ball = placed.add_instances(placed.add_mesh(*ball_mesh, prototype=True), [np.eye(4), away])
    there = away[:3, 3]
    hits = placed.closest_hit([[0, 0, 5], there + [0, 0, 5]], [0, 0, -1])
    assert (hits.geometry == ball).all() and hits.instance.tolist() == [0, 1]
    assert abs(hits.t[0] - hits.t[1]) < 1e-9 and hits.primitive[0] == hits.primitive[1]
    nearest = placed.closest_point(there + [0, 0, 5])
    assert (nearest.geometry, nearest.instance) == (ball, 1) and abs(nearest.distance - hits.t[1]) < 1e-9
    assert placed.contains([there, there + [0, 0, 5]]).tolist() == [True, False]


def test_a_whole_line_is_asked_for_by_infinities(ball, rng):
    origins, directions = rng.uniform(-2, 2, (500, 3)), rng.normal(size=(500, 3))
    for kind in (np.float32, np.float64):
        o, d = origins.astype(kind), directions.astype(kind)
        for t_min in (-np.inf, np.full(500, -np.inf, kind)):
            counts = ball.count_hits(o, d, t_min=t_min)
            np.testing.assert_array_equal(counts, ball.count_hits(o, d, t_min=-1e6))
            assert (counts % 2 == 0).all() and counts.max() == 2
            np.testing.assert_array_equal(ball.any_hit(o, d, t_min=t_min), counts > 0)
            first = ball.closest_hit(o, d, t_min=t_min)
            np.testing.assert_allclose(first.t, ball.closest_hit(o, d, t_min=-1e6).t, atol=1e-6)
            assert ball.all_hits(o, d, t_min=t_min).t.size == counts.sum()


def test_nearest_points_of_doubles_have_weights_in_double():
    scene = kdray.Scene(geometry="double")
    scene.add_mesh([[0, 0, 0], [3, 0, 0], [0, 7, 0]], [[0, 1, 2]])
    near = scene.closest_point([[1.0, 1, 1]])
    assert near.u[0] == pytest.approx(1 / 3, abs=1e-15) and near.v[0] == pytest.approx(1 / 7, abs=1e-15)


def test_what_vanishes_in_floats_is_told(rng):
    scene = kdray.Scene()
    scene.add_mesh([[-1e4, -1e4, 0], [1e4, -1e4, 0], [1e4, 1e4, 0]], [[0, 1, 2]])
    assert scene.commit().warnings == []
    facets = rng.uniform(5e3, 9e3, (1000, 1, 3)) + rng.uniform(-1e-4, 1e-4, (1000, 3, 3))
    scene.add_mesh(facets.reshape(-1, 3), np.arange(3000).reshape(-1, 3))
    (warning,) = [w for w in scene.commit().warnings if "single precision" in w]
    assert "too small for it to see" in warning and "double geometry" in warning


@pytest.mark.parametrize(
    "ask",
    [
        lambda s: s.info(-1),
        lambda s: s.remove(-1),
        lambda s: s.enable("a"),
        lambda s: s.closest_point([[0, 0, 0]], radius=None),
        lambda s: s.commit(3),
        lambda s: s.render(size=(16.5, 16)),
        lambda s: s.add_mesh([[0, 0, 0]], [[0, 0, 0]], material="red"),
    ],
)
def test_arguments_of_wrong_types_are_told_in_a_line(ball, ask):
    with pytest.raises(TypeError) as told:
        ask(ball)
    assert "\n" not in str(told.value) and "_core" not in str(told.value) and "kdray.Scene." in str(told.value)


@pytest.mark.parametrize("geometry", ["float", "double"])
@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize("place", [(0, 0, 0), (5e3, -2e3, 7)])
def test_rays_that_leave_a_convex_body_meet_nothing(ball_mesh, rng, geometry, kind, place):
    vertices, triangles = ball_mesh
    for body in ("mesh", "sphere", "box"):
        scene = kdray.Scene(geometry=geometry)
        if body == "mesh":
            scene.add_mesh(vertices + place, triangles)
        elif body == "sphere":
            scene.add_spheres([place], 1)
        else:
            low, high = np.array(place) - 0.7, np.array(place) + [0.3, 0.4, 0.5]
            corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)]) * (high - low) + low
            faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
            scene.add_mesh(corners, [[f[0], f[i], f[i + 1]] for f in faces for i in (1, 2)])
        o = (rng.normal(size=(4000, 3)) * 3 + place).astype(kind)
        d = (rng.uniform(-0.6, 0.6, (4000, 3)) + place - o).astype(kind)
        hits = scene.closest_hit(o, d, fields=("t", "normal"))
        onto = hits.hit & ((hits.normal * d).sum(axis=-1) < 0)
        assert onto.sum() > 1000
        out = rng.normal(size=(4000, 3))
        out -= hits.normal * (out * hits.normal).sum(axis=-1, keepdims=True)  # along the surface, or up to a degree off
        out += hits.normal * rng.choice([1e-6, 1e-3, 0.02, 1], 4000)[:, None]
        starts = scene.offset_origins(hits, out)
        assert starts.dtype == kind and starts.shape == (4000, 3)
        assert not scene.any_hit(starts[onto], out[onto].astype(kind)).any(), body
        inwards = scene.offset_origins(hits, -hits.normal)
        assert (scene.count_hits(inwards[onto], -hits.normal[onto].astype(kind)) == 1).all(), body


def test_meshes_are_given_back(tmp_path, ball_mesh):
    vertices, triangles = ball_mesh
    scene = kdray.Scene()
    id = scene.add_mesh(vertices, triangles)
    v, t = scene.mesh(id)
    np.testing.assert_array_equal(v, vertices)
    np.testing.assert_array_equal(t, triangles)
    scene.update_vertices(id, 2 * vertices)
    np.testing.assert_array_equal(scene.mesh(id)[0], 2 * vertices)
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0.1 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\n")
    v, t = kdray.load(tmp_path / "a.obj").mesh()
    assert v.tolist() == [[0, 0, 0], [1, 0.1, 0], [0, 1, 0], [1, 1, 0]] and t.shape == (2, 3)
    assert scene.mesh(scene.add_spheres([0, 0, 0], 1))[1].shape == (0, 3)
    with pytest.raises(kdray.errors.UsageError):
        scene.mesh(99)


@pytest.mark.parametrize("geometry", ["float", "double"])
@pytest.mark.parametrize("kind", [np.float32, np.float64])
@pytest.mark.parametrize("far", [10, 1e3, 1e5])
def test_rays_from_far_off_leave_what_they_hit(ball_mesh, rng, geometry, kind, far):
    scene = kdray.Scene(geometry=geometry)
    scene.add_mesh(*ball_mesh)
    o = rng.normal(size=(2000, 3))
    o = (far * o / np.linalg.norm(o, axis=-1, keepdims=True)).astype(kind)
    d = (rng.uniform(-0.5, 0.5, (2000, 3)) - o).astype(kind)
    hits = scene.closest_hit(o, d)
    normal = np.where((hits.normal * d).sum(axis=-1, keepdims=True) < 0, 1, -1) * hits.normal
    starts = scene.offset_origins(hits, normal)
    assert hits.hit.sum() > 1500 and not scene.any_hit(starts[hits.hit], normal[hits.hit].astype(kind)).any()
    one = scene.closest_hit(o[0], d[0])
    assert scene.offset_origins(one, normal[0]).shape == (3,)
    same = scene.closest_hit(o[0], d)  # from one place
    assert scene.offset_origins(same, same.normal).shape == (2000, 3)
