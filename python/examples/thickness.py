"""The wall thickness of a part, in a picture and a histogram.

    python thickness.py [-o thickness.png] [part.stl]

From each point of the surface a ray goes inwards, against the normal, to where it leaves the part. The mesh
is to be closed, and its normals are to point outwards.
"""

import argparse

import numpy as np

import kdray


def thickness(scene, points, normals):
    """How far it is from points of the surface, against the normals there, to the wall's other side.

    Whether a ray that starts on a surface meets that surface is up to the rounding of its origin, but no
    epsilon has to be guessed. A hit whose normal is against the ray is the way in; the same ray is then asked
    for what comes after just that hit: t_min is exclusive, and t is the same to the last bit each time.
    """
    inwards = -normals
    first = scene.closest_hit(points, inwards, fields=["t", "normal"])
    entered = (first.normal * inwards).sum(-1) < 0
    return scene.closest_hit(points, inwards, t_min=np.where(entered, first.t, 0), fields=["t"]).t


def cup(n=192):
    """A turned cup whose inside is 1.2 off the axis, so that one side is thin: vertices and triangles."""
    height = np.linspace(0, 1, 41)
    outer = np.stack([22 + 7 * height**2 - 3 * np.sin(5 * height), 60 * height], 1)  # radius, height
    profile = np.concatenate([[[0, 0]], outer, outer[:3:-1] - [2.5, 0], [[0, 6]]])
    angle = np.arange(n) * 2 * np.pi / n
    x = profile[:, :1] * np.cos(angle)
    x[len(outer) + 1 :] += 1.2
    y, z = profile[:, :1] * np.sin(angle), np.repeat(profile[:, 1:], n, 1)
    a = np.arange(x.size).reshape(x.shape)
    b, c, d = np.roll(a, -1, 1)[:-1], np.roll(a, -1, 1)[1:], a[1:]
    triangles = np.concatenate([np.stack([a[:-1], b, c], -1), np.stack([a[:-1], c, d], -1)])
    return np.stack([x, y, z], -1).reshape(-1, 3), triangles.reshape(-1, 3)


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", nargs="?", help="a part of your own")
    parser.add_argument("-o", "--output", default="thickness.png")
    parser.add_argument("--width", type=int, default=720)
    args = parser.parse_args(argv)

    scene = kdray.load(args.mesh) if args.mesh else kdray.Scene()
    if not args.mesh:
        scene.add_mesh(*cup())
    far = scene.closest_point(1e8 * np.vstack([np.eye(3), -np.eye(3)])).point  # the nearest are the scene's ends
    low, high = np.diag(far[3:]), np.diag(far[:3])
    eye = (low + high) / 2 + np.linalg.norm(high - low) * np.array([-0.35, -1, 0.7])
    camera = kdray.Camera(eye, target=(low + high) / 2, up=(0, 0, 1), fov=36)
    seen = scene.closest_hit(*kdray.pinhole_rays(camera, args.width, args.width * 3 // 4, dtype=np.float64))
    points, normals = (
        seen.point[seen.hit],
        seen.normal[seen.hit],
    )  # or the centres and normals of a mesh's faces
    walls = thickness(scene, points, normals)

    top = 2 * np.median(walls)
    counts, edges = np.histogram(walls, 16, (0, top))
    for count, edge in zip(counts, edges[1:], strict=True):
        print(f"to {edge:8.3g}  {'#' * round(60 * count / max(counts))}")
    print(f"median {top / 2:.3g}, thinnest {walls.min():.3g}; {np.mean(walls > top):.1%} thicker than {top:.3g}")

    x = np.minimum(walls / top, 1)  # red is thin, blue is thick
    stops = ([0.7, 1, 0.5, 0.05, 0.02], [0.02, 0.4, 0.75, 0.45, 0.1], [0.02, 0.05, 0.1, 0.6, 0.5])
    colour = np.stack([np.interp(x, [0, 0.25, 0.5, 0.75, 1], values) for values in stops], -1)
    pixels = np.ones((*seen.hit.shape, 3))
    pixels[seen.hit] = colour * (0.55 + 0.45 * np.abs(normals @ [-0.36, -0.8, 0.48]))[:, None]
    kdray.Picture(pixels).save(args.output)


if __name__ == "__main__":
    main()
