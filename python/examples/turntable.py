"""A mesh from all around: a contact sheet, or with --frames a file for each view.

    python turntable.py [-o turntable.png] [--views 12] [--frames] [--up y] [mesh.ply]

The tree is built once; each view is a call of `Scene.render` with another camera.
"""

import argparse

import numpy as np

import kdray


def knot(n=600, m=48):
    """A crooked trefoil of a round tube: vertices, triangles and normals."""
    s = np.arange(n)[:, None] * 2 * np.pi / n
    curve = np.hstack([np.sin(s) + 2 * np.sin(2 * s), np.cos(s) - 2 * np.cos(2 * s), 0.8 * np.cos(s) - np.sin(3 * s)])
    along = np.roll(curve, -1, 0) - np.roll(curve, 1, 0)
    side = np.cross(along, [0, 0, 1])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    other = np.cross(along, side)
    other /= np.linalg.norm(other, axis=1, keepdims=True)
    angle = np.arange(m)[:, None] * 2 * np.pi / m
    normals = np.cos(angle) * side[:, None] + np.sin(angle) * other[:, None]
    a = np.arange(n * m).reshape(n, m)
    b, c, d = np.roll(a, -1, 0), np.roll(a, (-1, -1), (0, 1)), np.roll(a, -1, 1)
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    return (curve[:, None] + 0.6 * normals).reshape(-1, 3), triangles, normals.reshape(-1, 3)


def cameras(scene, views, upwards="z", tilt=25.0, fov=30.0):
    """Cameras on a circle around the scene's middle that see all of it."""
    far = scene.closest_point(1e8 * np.vstack([np.eye(3), -np.eye(3)])).point  # the nearest are the scene's ends
    low, high = np.diag(far[3:]), np.diag(far[:3])
    middle, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    away = radius / np.sin(np.radians(fov / 2))
    up, flat = np.sin(np.radians(tilt)), np.cos(np.radians(tilt))
    frame = np.eye(3) if upwards == "z" else np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])  # rows: right, back, up
    for azimuth in np.arange(views) * 2 * np.pi / views:
        to_eye = np.array([flat * np.sin(azimuth), -flat * np.cos(azimuth), up]) @ frame
        yield kdray.Camera(middle + away * to_eye, middle, frame[2], fov)


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", nargs="?", help="a mesh of your own")
    parser.add_argument("-o", "--output", default="turntable.png")
    parser.add_argument("--views", type=int, default=12)
    parser.add_argument("--size", type=int, default=200, help="of a view, in pixels")
    parser.add_argument("--up", choices=["y", "z"], default="z", help="which way is up")
    parser.add_argument("--frames", action="store_true", help="write turntable-000.png and so on")
    args = parser.parse_args(argv)

    scene = kdray.load(args.mesh, smooth=40) if args.mesh else kdray.Scene()
    if not args.mesh:
        vertices, triangles, normals = knot()
        paint = kdray.Material(diffuse=(0.7, 0.28, 0.1), specular=(0.4, 0.35, 0.3), shine=60)
        scene.add_mesh(vertices, triangles, normals=normals, material=scene.add_material(paint))
        for direction, light in [((1, 1, -1), 0.8), ((-1, 0.2, -1), 0.5), ((0, -1, -0.5), 0.4)]:
            scene.add_light(kdray.Light("directional", direction=direction, color=(light, light, light)))
    scene.set_background((0.75, 0.8, 0.85))
    places = cameras(scene, args.views, args.up)
    views = [scene.render(camera, (args.size, args.size), samples=4) for camera in places]
    if args.frames:
        name, dot, ending = args.output.rpartition(".")
        for i, view in enumerate(views):
            view.save(f"{name}-{i:03}{dot}{ending}")
        return
    columns = next(n for n in range(int(np.ceil(args.views**0.5)), args.views + 1) if args.views % n == 0)
    rows = [np.concatenate(views[i : i + columns], axis=1) for i in range(0, args.views, columns)]
    kdray.Picture(np.concatenate(rows)).save(args.output)


if __name__ == "__main__":
    main()
