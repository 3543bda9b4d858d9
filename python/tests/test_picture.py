"""Pictures: what they show, and files."""

import copy
import pickle

import numpy as np
import pytest

import kdray


@pytest.fixture(scope="module")
def lit() -> kdray.Scene:
    scene = kdray.Scene()
    scene.add_spheres([0, 0, 0], 1)
    scene.set_background((0, 0, 1))
    return scene


def test_the_ball_is_where_rays_hit_it(lit):
    camera = kdray.Camera((0, 1, 5), fov=30)
    picture = lit.render(camera, (60, 40), look="plain", channels=["depth", "primitive"])
    assert picture.shape == (40, 60, 3) and picture.dtype == np.float32
    o, d = kdray.pinhole_rays(camera, 60, 40)
    hits = lit.closest_hit(o, d)
    np.testing.assert_array_equal(picture.channels["primitive"] >= 0, hits.hit)
    depth = picture.channels["depth"]
    length = np.linalg.norm(d, axis=-1)
    np.testing.assert_allclose(depth[hits.hit], (hits.t * length)[hits.hit], rtol=1e-5)
    assert (picture[~hits.hit] == [0, 0, 1]).all() and (picture[hits.hit, 2] < 1).all()


def test_orthographic_rays_are_those_of_pictures(lit):
    camera = kdray.Camera((0, 0, 5), ortho_width=4)
    picture = lit.render(camera, (32, 24), channels=["primitive"])
    np.testing.assert_array_equal(
        picture.channels["primitive"] >= 0, lit.closest_hit(*kdray.pinhole_rays(camera, 32, 24)).hit
    )


def test_backgrounds_by_direction(tmp_path):
    scene = kdray.Scene()
    scene.set_gradient([0, 0.5], [(0, 0, 0), (1, 0.5, 0)])
    camera = kdray.Camera((0, 0, 0), (0, 0, -1), fov=60)
    rows = scene.render(camera, (1, 8))[:, 0]
    assert (rows[4:] == 0).all() and (np.diff(rows[:4, 0]) < 0).all()
    (tmp_path / "sky.hdr").write_bytes(b"#?RADIANCE\n\n-Y 1 +X 1\n" + bytes([128, 64, 0, 129]))
    scene.set_environment(tmp_path / "sky.hdr", strength=0.5)
    assert (scene.render(camera, (2, 2)) == [0.5, 0.25, 0]).all()
    assert (pickle.loads(pickle.dumps(scene)).render(camera, (2, 2)) == [0.5, 0.25, 0]).all()
    with pytest.raises(kdray.errors.InputError):
        scene.set_environment(tmp_path / "none.hdr")


def test_a_lamp_of_some_size_throws_a_soft_shadow():
    scene = kdray.Scene()
    scene.add_discs([[0, 0, 0]], [0, 1, 0], 5)
    scene.add_discs([[0, 1, 0]], [0, 1, 0], 0.5)
    scene.add_light(kdray.Light("sphere", position=(0, 2, 0), radius=0.4))
    camera = kdray.Camera((0, 0.5, 0), (0, 0, 0), up=(0, 0, 1), ortho_width=4, aperture=0.01, focus=0.5)
    row = np.asarray(scene.render(camera, (64, 1), samples=64))[0, :, 0]
    assert row.min() < 0.1 < 0.3 < row.max()
    assert ((row > 0.12) & (row < row.max() * 0.8)).sum() > 8


def test_colors_are_those_of_the_material():
    scene = kdray.Scene()
    glow = scene.add_material(kdray.Material(emission=(0.25, 0.5, 1), diffuse=(0, 0, 0)))
    scene.add_spheres([0, 0, 0], 1, material=glow)
    scene.set_ambient((0, 0, 0))
    picture = scene.render(kdray.Camera((0, 0, 5)), (3, 3))
    np.testing.assert_allclose(picture[1, 1], [0.25, 0.5, 1], atol=1e-6)


def test_a_material_is_only_of_those_it_was_given_to():
    camera = kdray.Camera((0, 0, 5))
    scene = kdray.Scene()
    scene.add_spheres([0, 0, 0], 1)
    grey = scene.render(camera, (3, 3))[1, 1]
    glow = scene.add_material(kdray.Material(emission=(1, 0, 0)))
    np.testing.assert_array_equal(scene.render(camera, (3, 3))[1, 1], grey)
    scene.add_spheres([0, 0, 0], 1.5, material=glow)
    assert scene.render(camera, (3, 3))[1, 1, 0] >= 1


def test_looks():
    scene = kdray.Scene()
    scene.add_spheres([0, 0, 0], 1)
    plain, studio = (np.asarray(scene.render(size=(24, 24), look=look)) for look in ("plain", "studio"))
    np.testing.assert_array_equal(scene.render(size=(24, 24)), studio)
    np.testing.assert_array_equal(scene.render(size=(24, 24), look="plain"), plain)
    assert plain.min() == 0 and studio.min() > 0.02  # black behind it, and a backdrop
    assert not np.array_equal(scene.render(size=(24, 24), samples=1), studio)
    # The floor is in pictures alone.
    depth = scene.render(size=(24, 24), channels=["depth"]).channels["depth"]
    assert np.isinf(depth).any() and depth.min() > 1
    assert not scene.any_hit([5, 5, 5], [0, -1, 0])
    scene.add_light(kdray.Light("directional", direction=(1, -1, -1)))
    np.testing.assert_array_equal(scene.render(size=(24, 24)), scene.render(size=(24, 24), look="plain"))
    with pytest.raises(kdray.UsageError, match="look is one of"):
        scene.render(size=(8, 8), look="nice")


def test_saving(lit, tmp_path):
    picture = lit.render(size=(20, 10), channels=["depth"])
    files = picture.save(tmp_path / "a.png")
    assert [file.rsplit("/", 1)[1] for file in files] == ["a.png", "a.depth.png"]
    assert (tmp_path / "a.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    assert picture.save(tmp_path / "a.exr") == [str(tmp_path / "a.exr")]
    assert picture._repr_png_()[:4] == b"\x89PNG"
    assert picture[:4].channels == {} and picture[:4].save(tmp_path / "part.png")
    with pytest.raises(kdray.InputError, match="bmp"):
        picture.save(tmp_path / "a.bmp")
    with pytest.raises(ValueError, match="height x width x 3"):
        picture[0].save(tmp_path / "row.png")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.depth.png", "a.exr", "a.png", "part.png"]


def test_a_size_may_be_an_array_and_has_two_sides(lit):
    assert lit.render(size=np.array([8, 6])).shape == (6, 8, 3)
    with pytest.raises(kdray.UsageError, match=r"size is \(width, height\), not 8"):
        lit.render(size=8)


def test_what_is_made_of_a_picture(lit):
    picture = lit.render(size=(8, 6), channels=["depth"])
    assert isinstance(picture.mean(), np.floating) and round(picture.max(), 2) >= 0
    other = picture.copy()
    other.channels["depth"][:] = 7
    assert not (picture.channels["depth"] == 7).any()
    assert set(kdray.Picture(picture).channels) == {"depth"}


@pytest.mark.parametrize(
    ("ending", "name"), [("exr", "R"), ("exr", ""), ("png", ""), ("png", "../depth"), ("exr", "a/b")]
)
def test_names_of_channels_that_are_refused(tmp_path, ending, name):
    picture = kdray.Picture(np.zeros((2, 3, 3)), {name: np.ones((2, 3), np.float32)})
    with pytest.raises(kdray.InputError, match="a channel can't have the name"):
        picture.save(tmp_path / f"x.{ending}")
    assert not list(tmp_path.iterdir())


def test_channels_that_do_not_fit_and_arguments_of_other_types(tmp_path):
    with pytest.raises(kdray.InputError, match=r"the channel a is \(3, 2\), and the picture \(2, 3\)"):
        kdray.Picture(np.zeros((2, 3, 3)), {"a": np.ones((3, 2), np.float32)}).save(tmp_path / "x.exr")
    with pytest.raises(TypeError, match=r"kdray.Picture.save\(.*bits=16.5\): an argument"):
        kdray.Picture(np.zeros((2, 3, 3))).save(tmp_path / "x.png", bits=16.5)
    with pytest.raises(TypeError, match=r"kdray.load\('a.obj', smooth='x'\): an argument"):
        kdray.load("a.obj", smooth="x")
    kdray.Picture(np.zeros((2, 3, 3))).save(bytes(tmp_path / "y.png"))
    assert (tmp_path / "y.png").exists()


def test_a_lens_blurs_what_is_not_in_focus(lit):
    def shown(**lens):
        return lit.render(kdray.Camera((0, 0, 5), **lens), (24, 18), samples=64)

    sharp, focused, blurred = shown(), shown(aperture=0.5, focus=4.9), shown(aperture=2, focus=1)
    edge = [np.abs(np.diff(np.asarray(p)[..., 2], axis=1)).max() for p in (sharp, focused, blurred)]
    assert edge[0] > 0 and not (sharp == focused).all()
    assert edge[2] < 0.5 * edge[0]


def test_an_exposure_doubles_what_a_png_shows(lit, tmp_path):
    picture = lit.render(size=(16, 12))
    picture.save(tmp_path / "a.png", exposure=1)
    kdray.Picture(2 * picture).save(tmp_path / "b.png")
    picture.save(tmp_path / "c.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes() != (tmp_path / "c.png").read_bytes()
    with pytest.raises(kdray.UsageError, match="exposure"):
        picture.save(tmp_path / "d.png", exposure=float("nan"))


def test_pickled_pictures_are_the_same(lit):
    picture = lit.render(size=(8, 8), channels=["depth"])
    again = pickle.loads(pickle.dumps(picture))
    np.testing.assert_array_equal(again, picture)
    np.testing.assert_array_equal(again.channels["depth"], picture.channels["depth"])


def test_progress_is_told_and_may_end_it(lit):
    told = []
    lit.render(size=(256, 256), samples=4, progress=told.append)
    assert told == sorted(told) and told[-1] == 1

    def stop(share):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        lit.render(size=(256, 256), progress=stop)


def test_a_part_has_the_pixels_of_the_whole(lit):
    camera = kdray.Camera((0, 1, 5), fov=30)
    whole = lit.render(camera, (60, 40), samples=4, channels=["depth"])
    part = lit.render(camera, (60, 40), samples=4, channels=["depth"], crop=(21, 9, 30, 20))
    np.testing.assert_array_equal(part, whole[9:29, 21:51])
    np.testing.assert_array_equal(part.channels["depth"], whole.channels["depth"][9:29, 21:51])
    for wrong in [(0, 0, 61, 1), (-1, 0, 2, 2), (0, 0, 0, 1)]:
        with pytest.raises(kdray.errors.UsageError, match="does not lie within the picture of 60x40"):
            lit.render(camera, (60, 40), crop=wrong)


def test_a_part_says_where_it_lies(lit, tmp_path):
    part = lit.render(size=(60, 40), samples=1, crop=(21, 9, 30, 20))
    part.save(tmp_path / "a.exr", within=(21, 9, 60, 40))
    header = (tmp_path / "a.exr").read_bytes()

    def window(name):
        at = header.index(name + b"\0box2i\0") + len(name) + 11
        return np.frombuffer(header, "<i4", 4, at).tolist()

    assert window(b"dataWindow") == [21, 9, 50, 28] and window(b"displayWindow") == [0, 0, 59, 39]
    for wrong in [(31, 9, 60, 40), (-1, 0, 60, 40), (0, 0, 29, 40), (0, 0, 2**31 - 1, 2**31 - 1), (1, 0, -(2**31), 9)]:
        with pytest.raises(kdray.UsageError, match="within"):
            part.save(tmp_path / "b.exr", within=wrong)
    assert not (tmp_path / "b.exr").exists()


def test_wrong_options(lit):
    with pytest.raises(kdray.UsageError, match="mode is one of"):
        lit.render(size=(8, 8), mode="fast")
    for wrong in ({"size": (0, 8)}, {"samples": 0}, {"depth": -1}):
        with pytest.raises(kdray.UsageError, match="at least 1"):
            lit.render(**wrong)
    with pytest.raises(kdray.UsageError, match="three coordinates"):
        lit.render(kdray.Camera((0, 0)))
    with pytest.raises(kdray.Error):
        lit.render(kdray.Camera((0, 0, 5), up=(0, 0, 1)), size=(8, 8))


def test_colours_may_be_written_as_the_web_does(lit):
    def seen(background, diffuse, light):
        scene = kdray.Scene()
        scene.add_spheres([0, 0, 0], 1, material=scene.add_material(kdray.Material(diffuse=diffuse)))
        scene.add_light(kdray.Light("directional", color=light))
        scene.set_background(background)
        scene.set_ambient(background)
        return scene.render(kdray.Camera((0, 0, 5)), (16, 16))

    np.testing.assert_array_equal(seen("red", "#ff0", "white"), seen((1, 0, 0), (1, 1, 0), (1, 1, 1)))
    np.testing.assert_allclose(seen("#808080", "lime", "#fff")[0, 0], 0.2158605, rtol=1e-6)
    scene = kdray.Scene()
    scene.set_gradient([-1, 1], ["navy", (0, 0, 1)])
    with pytest.raises(kdray.UsageError, match="'skybleu'"):
        scene.set_background("skybleu")


def test_a_turned_picture_has_no_channels_that_do_not_fit(lit):
    picture = lit.render(kdray.Camera((0, 1, 5)), (8, 8), channels="depth", look="plain")
    assert set(picture.channels) == {"depth"}
    kept = [picture * 0.5, 2 - picture, picture[:], picture.copy(), copy.copy(picture), copy.deepcopy(picture)]
    kept += [picture * np.array([1.1, 1, 0.9]), picture.astype(np.float64), np.clip(picture, 0, 1), np.sqrt(picture)]
    kept += [pickle.loads(pickle.dumps(picture))]
    for same in kept:
        np.testing.assert_array_equal(same.channels["depth"], picture.channels["depth"])
    turned = [np.flipud(picture), picture[::-1], picture.transpose(1, 0, 2), np.rot90(picture), np.roll(picture, 1, 0)]
    turned += [picture[np.arange(7, -1, -1)], np.take(picture, [0] * 8, axis=0), picture[:4], picture[..., 0]]
    for other in turned:
        for made in (other, other.copy(), other * 1.0, copy.copy(other), other.astype(np.float64)):
            assert made.channels == {}
    picture *= 2
    assert set(picture.channels) == {"depth"}
    picture.channels = {}
    assert picture.channels == {}
    with pytest.raises(ValueError, match="no pixels"):
        kdray.Picture(np.zeros((0, 4, 3))).save("a.png")


def test_an_environment_is_found_from_elsewhere(tmp_path, monkeypatch):
    (tmp_path / "sky.hdr").write_bytes(b"#?RADIANCE\n\n-Y 1 +X 1\n" + bytes([128, 64, 0, 129]))
    monkeypatch.chdir(tmp_path)
    scene = kdray.Scene()
    scene.set_environment("sky.hdr")
    monkeypatch.chdir("/")
    assert (scene.copy().render(kdray.Camera((0, 0, 1)), (1, 1)) == [1, 0.5, 0]).all()


@pytest.mark.parametrize(
    "wrong", [{"adaptive": -1}, {"adaptive": float("nan")}, {"min_weight": -1}, {"min_weight": float("nan")}]
)
def test_options_out_of_range_are_refused(lit, wrong):
    with pytest.raises(kdray.errors.UsageError, match=next(iter(wrong))):
        lit.render(size=(2, 2), **wrong)
