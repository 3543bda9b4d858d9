"""Pictures on meshes: where their pixels come to lie, what they multiply, and what is refused."""

import base64
import json
import pickle
import struct
import zlib

import numpy as np
import pytest

import kdray

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
HALVES = [[0, 1, 2], [0, 2, 3]]
UV = [[0, 1], [1, 1], [1, 0], [0, 0]]  # a picture's lower edge lies at y = 0
FRONT = kdray.Camera((0.5, 0.5, 2), (0.5, 0.5, 0), ortho_width=1)
SEEN = {"ambient": (1, 1, 1), "diffuse": (0, 0, 0)}  # as bright as the picture says, whatever the lights


def linear(codes):
    """The sRGB standard's curve, in double."""
    v = np.asarray(codes) / 255
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


def square(material=None, pixels=None, **terms) -> kdray.Scene:
    scene = kdray.Scene()
    if pixels is not None:
        material = kdray.Material(picture=scene.add_picture(pixels), **(SEEN | terms))
    scene.add_mesh(SQUARE, HALVES, uv=UV, material=scene.add_material(material))
    scene.set_ambient((1, 1, 1))
    return scene


def shown(scene, size):
    return np.asarray(scene.render(FRONT, (size, size), look="plain"))


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
def test_each_pixel_is_where_it_should_be(rng, channels):
    pixels = rng.integers(0, 256, (8, 8, channels), np.uint8)
    colors = linear(pixels[..., :3] if channels > 2 else np.repeat(pixels[..., :1], 3, axis=-1))
    # One ray in the middle of each of the picture's pixels.
    np.testing.assert_allclose(shown(square(pixels=pixels), 8), colors, atol=2e-4)


def test_pixels_of_any_layout_are_the_same(rng):
    pixels = rng.integers(0, 256, (8, 8, 3), np.uint8)
    wanted = shown(square(pixels=pixels), 8)
    wider = np.zeros((8, 20, 3), np.uint8)
    wider[:, 3:11] = pixels
    for same in (np.asfortranarray(pixels), wider[:, 3:11], pixels[::-1, ::-1].copy()[::-1, ::-1]):
        np.testing.assert_array_equal(shown(square(pixels=same), 8), wanted)
    flat = rng.integers(0, 256, (8, 8), np.uint8)
    np.testing.assert_array_equal(shown(square(pixels=flat), 8), shown(square(pixels=np.stack([flat] * 3, axis=-1)), 8))


def test_what_was_given_may_change_afterwards():
    pixels = np.full((2, 2, 3), 255, np.uint8)
    scene = square(pixels=pixels)
    pixels[:] = 0
    assert (shown(scene, 2) == 1).all()


def test_coordinates_beyond_the_picture_repeat_it():
    stripes = np.zeros((1, 2, 3), np.uint8)
    stripes[:, 1] = 255
    scene = kdray.Scene()
    material = scene.add_material(kdray.Material(picture=scene.add_picture(stripes), **SEEN))
    scene.add_mesh(SQUARE, HALVES, uv=4 * np.array(UV) - 2, material=material)
    scene.set_ambient((1, 1, 1))
    np.testing.assert_allclose(shown(scene, 8)[3, :, 0], [0, 1] * 4, atol=1e-6)


def test_holes_and_veils():
    pixels = np.full((2, 2, 4), 255, np.uint8)
    pixels[:, 0, 3] = 51  # a fifth
    cut, veil, opaque = (square(pixels=pixels, alpha=alpha) for alpha in ("mask", "blend", "opaque"))
    for scene in (cut, veil, opaque):
        scene.set_background((0, 0.5, 0))
    assert (shown(cut, 2)[:, 0] == [0, 0.5, 0]).all() and (shown(cut, 2)[:, 1] == 1).all()
    np.testing.assert_allclose(shown(veil, 2)[0, 0], [0.2, 0.6, 0.2], atol=1e-4)
    assert (shown(opaque, 2) == 1).all()


def test_what_glows():
    pixels = np.full((1, 1, 3), (255, 0, 255), np.uint8)
    scene = kdray.Scene()
    black = {"ambient": (0, 0, 0), "diffuse": (0, 0, 0)}
    glow = kdray.Material(emission=(0.5, 0.5, 0.25), emission_picture=scene.add_picture(pixels), **black)
    scene.add_mesh(SQUARE, HALVES, uv=UV, material=scene.add_material(glow))
    np.testing.assert_allclose(shown(scene, 1)[0, 0], [0.5, 0, 0.25], atol=1e-6)


def test_bent_normals():
    """Light along -z meets a normal bent by the picture's x or y at the cosine that it says."""
    for code in ((255, 128, 255), (128, 255, 255), (128, 128, 255)):
        scene = kdray.Scene()
        number = scene.add_picture(np.full((1, 1, 3), code, np.uint8))
        matt = kdray.Material(ambient=(0, 0, 0), diffuse=(1, 1, 1), normal_picture=number)
        scene.add_mesh(SQUARE, HALVES, uv=UV, material=scene.add_material(matt))
        scene.add_light(kdray.Light("directional", direction=(0.6, 0.3, -1)))
        normal = 2 * np.array(code) / 255 - 1
        towards = -np.array([0.6, 0.3, -1.0])
        cosine = normal @ towards / np.linalg.norm(normal) / np.linalg.norm(towards)
        np.testing.assert_allclose(shown(scene, 1)[0, 0], max(cosine, 0), atol=2e-3)


def png(pixels: np.ndarray) -> bytes:
    """A PNG file of an array (h, w, 3), written without kdray."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + row.tobytes() for row in pixels)
    head = struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 8, 2, 0, 0, 0)
    body = chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def gltf_square(material: dict, pictures: list) -> str:
    corners = np.array(SQUARE, np.float32).tobytes()
    faces = np.array(HALVES, np.uint32).tobytes()
    data = corners + faces + np.array(UV, np.float32).tobytes()

    def uri(kind: str, content: bytes) -> str:
        return f"data:{kind};base64,{base64.b64encode(content).decode()}"

    parts = ((0, len(corners)), (len(corners), len(faces)), (len(corners) + len(faces), 32))
    kinds = ((5126, 4, "VEC3"), (5125, 6, "SCALAR"), (5126, 4, "VEC2"))
    return json.dumps(
        {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1, "material": 0}]}],
            "buffers": [{"byteLength": len(data), "uri": uri("application/octet-stream", data)}],
            "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": n} for at, n in parts],
            "accessors": [
                {"bufferView": i, "componentType": c, "count": n, "type": t} for i, (c, n, t) in enumerate(kinds)
            ],
            "materials": [material],
            "images": [{"uri": uri("image/png", png(pixels))} for pixels in pictures],
            "textures": [{"source": i} for i in range(len(pictures))],
        }
    )


def test_metal_and_occlusion_are_those_of_gltf(tmp_path, rng):
    metal, occlusion = rng.integers(0, 256, (2, 8, 8, 3), np.uint8)
    factors = {"baseColorFactor": [0.75, 0.5, 0.25, 1], "metallicFactor": 0.75, "roughnessFactor": 0.5}
    material = {
        "pbrMetallicRoughness": factors | {"metallicRoughnessTexture": {"index": 0}},
        "occlusionTexture": {"index": 1, "strength": 0.5},
    }
    (tmp_path / "square.gltf").write_text(gltf_square(material, [metal, occlusion]))
    loaded, made = kdray.load(tmp_path / "square.gltf"), kdray.Scene()
    same = kdray.Material(
        diffuse=(0.75, 0.5, 0.25),
        metal_picture=made.add_picture(metal),
        metallic=0.75,
        roughness=0.5,
        occlusion_picture=made.add_picture(occlusion),
        occlusion=0.5,
    )
    made.add_mesh(SQUARE, HALVES, uv=UV, material=made.add_material(same))
    for scene in (loaded, made):
        scene.set_ambient((0.5, 0.75, 1))
        scene.set_background((0.25, 0.5, 1))
        scene.add_light(kdray.Light("directional", direction=(0.25, 0.5, -1)))
    np.testing.assert_array_equal(shown(made, 16), shown(loaded, 16))
    np.testing.assert_array_equal(shown(made.copy(), 16), shown(loaded, 16))
    assert np.ptp(shown(made, 16)) > 0.1


def test_files(tmp_path, rng):
    pixels = rng.integers(0, 256, (8, 8, 3), np.uint8)
    scene = square(pixels=pixels)
    scene.render(FRONT, (8, 8), look="plain").save(tmp_path / "same.png")
    again = kdray.Scene()
    material = kdray.Material(picture=again.add_picture(tmp_path / "same.png"), **SEEN)
    again.add_mesh(SQUARE, HALVES, uv=UV, material=again.add_material(material))
    again.set_ambient((1, 1, 1))
    np.testing.assert_allclose(shown(again, 8), linear(pixels), atol=2e-3)


def test_copies_have_the_pictures(rng):
    scene = square(pixels=rng.integers(0, 256, (8, 8, 4), np.uint8), alpha="blend")
    wanted = shown(scene, 16)
    for same in (scene.copy(), pickle.loads(pickle.dumps(scene))):
        np.testing.assert_array_equal(shown(same, 16), wanted)
    scene.update_vertices(0, np.array(SQUARE) + [0, 0, 0.25])  # coordinates stay, also in copies made later
    np.testing.assert_array_equal(shown(scene.copy(), 16), shown(scene, 16))


@pytest.mark.parametrize(
    ("pixels", "what"),
    [
        (np.zeros((2, 2, 3), np.float32), "uint8"),
        (np.zeros((2, 2, 3), np.uint16), "uint8"),
        (np.zeros((2, 2), bool), "uint8"),
        (np.zeros((2, 2, 5), np.uint8), "shape"),
        (np.zeros(4, np.uint8), "shape"),
        (np.zeros((2, 2, 3, 1), np.uint8), "shape"),
        (np.zeros((0, 2, 3), np.uint8), "no pixels"),
        (np.zeros((2, 0), np.uint8), "no pixels"),
        (np.zeros((1, 16385), np.uint8), "16385"),
        (np.zeros((16384, 16384), np.uint8)[::2, :], "16384"),
        ([[["a"]]], "uint8"),
    ],
)
def test_pictures_that_are_none(pixels, what):
    scene = kdray.Scene()
    with pytest.raises(kdray.errors.InputError, match=what):
        scene.add_picture(pixels)
    assert scene.add_picture(np.zeros((1, 1), np.uint8)) == 0


def test_files_that_are_none(tmp_path):
    scene = kdray.Scene()
    good = square(pixels=np.zeros((4, 4, 3), np.uint8)).render(FRONT, (4, 4))
    good.save(tmp_path / "good.png")
    whole = (tmp_path / "good.png").read_bytes()
    for name, data in (
        ("empty", b""),
        ("cut", whole[:40]),
        ("text", b"no picture"),
        ("noise", whole[:8] + b"\xff" * 99),
    ):
        (tmp_path / name).write_bytes(data)
        with pytest.raises(kdray.errors.InputError, match=name):
            scene.add_picture(tmp_path / name)
    with pytest.raises(kdray.errors.InputError, match="none"):
        scene.add_picture(str(tmp_path / "none.png"))


@pytest.mark.parametrize(
    "uv", [[[0, 0]] * 3, [[0, 0, 0]] * 4, [0, 1, 2, 3], [["a", "b"]] * 4, [[0, np.nan]] * 4, [[np.inf, 0]] * 4]
)
def test_wrong_coordinates(uv):
    scene = kdray.Scene()
    with pytest.raises(kdray.errors.InputError):
        scene.add_mesh(SQUARE, HALVES, uv=uv)
    assert scene.geometries == []


def test_wrong_materials():
    scene = kdray.Scene()
    scene.add_picture(np.zeros((1, 1), np.uint8))
    for number in (-1, 1, 2**32 - 1, 2**40):
        with pytest.raises(kdray.errors.UsageError, match="picture"):
            scene.add_material(kdray.Material(picture=number))
        with pytest.raises(kdray.errors.UsageError, match="picture"):
            scene.add_material(kdray.Material(metal_picture=number))
    with pytest.raises(kdray.errors.InputError, match="roughness"):
        scene.add_material(kdray.Material(roughness=2))
    with pytest.raises(kdray.errors.UsageError, match="alpha"):
        scene.add_material(kdray.Material(picture=0, alpha="holes"))
    with pytest.raises(kdray.errors.InputError, match="alpha"):
        scene.add_material(kdray.Material(alpha="mask"))
    assert scene.add_material(kdray.Material(picture=0)) == 1


class PillowImage:
    """As Pillow's are: bytes of a palette or of other colours, until they are converted."""

    def __init__(self, mode, pixels, converted=None, info=()):
        self.mode, self.pixels, self.converted, self.info = mode, pixels, converted or {}, info

    def convert(self, mode):
        return PillowImage(mode, self.converted[mode])

    def __array__(self, dtype=None, copy=None):
        return self.pixels


@pytest.mark.parametrize(
    "mode, bytes_of, info",
    [("P", 1, ()), ("P", 1, ("transparency",)), ("CMYK", 4, ()), ("HSV", 3, ()), ("YCbCr", 3, ()), ("RGB", 3, ())],
)
def test_images_of_pillow_show_their_colours(mode, bytes_of, info):
    red = np.full((4, 4, 4 if info else 3), [255, 0, 0, 255][: 4 if info else 3], np.uint8)
    raw = red if mode == "RGB" else np.full((4, 4, bytes_of), 17, np.uint8)
    image = PillowImage(mode, raw, {"RGBA" if info else "RGB": red}, info)
    np.testing.assert_array_equal(shown(square(pixels=image), 3), np.full((3, 3, 3), [1.0, 0, 0]))
