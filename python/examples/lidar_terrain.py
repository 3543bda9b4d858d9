"""A LiDAR sweep over a terrain at UTM coordinates: its points as a PLY, and a picture, coloured by range.

    python lidar_terrain.py [-o lidar_terrain.png] [terrain.ply]

Coordinates of 500 and 5000 kilometres keep their millimetres: vertices, rays and points are float64, where
float32 would know northings to half a metre only. A terrain of your own is to have z up, and metres.
"""

import argparse

import numpy as np

import kdray

WEST, SOUTH, SIZE = 500_000.0, 5_000_000.0, 1000.0


def height(east, north):
    x, y = (east - WEST) / SIZE, (north - SOUTH) / SIZE
    ridges = 1 - np.abs(np.sin(5 * x + 2 * np.sin(4 * y)))
    return 300 + 90 * ridges * y + 25 * np.sin(9 * x) * np.cos(7 * y) + 6 * np.sin(41 * x + 5 * y) * np.sin(37 * y)


def terrain(n):
    """Vertices and triangles of n x n heights."""
    x, y = np.meshgrid(WEST + np.linspace(0, SIZE, n), SOUTH + np.linspace(0, SIZE, n))
    i = np.arange(n * n).reshape(n, n)
    a, b, c, d = (corner.ravel() for corner in (i[:-1, :-1], i[:-1, 1:], i[1:, 1:], i[1:, :-1]))
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return np.stack([x, y, height(x, y)], -1).reshape(-1, 3), triangles


def sweep(scene, scanner, beams, steps, reach=600.0):
    """The points that a spinning scanner sees, and their ranges: t, since directions have length 1."""
    origins, directions = kdray.lidar_rays(scanner, np.linspace(-35, 10, beams), steps=steps)
    hits = scene.closest_hit(origins, directions, t_max=reach, fields=["t", "point"])
    return hits.point[hits.hit], hits.t[hits.hit]


def write_ply(path, points, ranges):
    rows = np.column_stack([points, ranges]).astype("<f8")
    names = "".join(f"property double {name}\n" for name in ("x", "y", "z", "range"))
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {len(rows)}\n{names}end_header\n"
    with open(path, "wb") as file:
        file.write(head.encode() + rows.tobytes())


def add_points(scene, points, ranges, size, colours=32):
    """The points as balls, from yellow (near) over red to blue (far)."""
    group = (ranges / ranges.max() * (colours - 1)).astype(int)
    for i in np.unique(group):
        stops = ([1, 0.9, 0.4, 0.02], [0.7, 0.1, 0, 0.2], [0.05, 0, 0.3, 0.9])
        rgb = [np.interp(i / colours, [0, 0.35, 0.65, 1], values) for values in stops]
        paint = scene.add_material(kdray.Material(diffuse=(0, 0, 0), emission=rgb))
        scene.add_spheres(points[group == i], size, material=paint)


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", nargs="?", help="a terrain of your own")
    parser.add_argument("-o", "--output", default="lidar_terrain.png")
    parser.add_argument("--beams", type=int, default=64)
    parser.add_argument("--steps", type=int, default=1024)
    args = parser.parse_args(argv)

    scene = kdray.load(args.mesh) if args.mesh else kdray.Scene()
    if not args.mesh:
        grey = scene.add_material(kdray.Material(diffuse=(0.35, 0.35, 0.33)))
        scene.add_mesh(*terrain(400), material=grey)
    far = scene.closest_point(1e8 * np.vstack([np.eye(3), -np.eye(3)])).point  # the nearest are the scene's ends
    low, high = np.diag(far[3:]), np.diag(far[:3])
    middle, wide = (low + high) / 2, np.linalg.norm((high - low)[:2])
    ground = scene.closest_hit([*middle[:2], high[2] + 1], [0, 0, -1]).point  # looked up from above
    points, ranges = sweep(scene, ground + np.array([0, 0, 25]), args.beams, args.steps)
    if not len(points):
        parser.error("the scanner sees nothing: is z up, and ground in the middle?")
    write_ply(args.output.rsplit(".", 1)[0] + ".ply", points, ranges)
    print(f"{len(points)} points of {args.beams * args.steps} rays, {ranges.min():.1f} to {ranges.max():.1f} m")

    add_points(scene, points, ranges, size=wide / 1000)
    scene.add_light(kdray.Light("directional", direction=(1, -0.4, -0.8)))
    scene.set_background((0.8, 0.85, 0.9))
    camera = kdray.Camera(middle + wide * np.array([0.1, -0.65, 0.5]), middle - [0, 0.05 * wide, 0], (0, 0, 1), 40)
    scene.render(camera, size=(840, 480), samples=4).save(args.output)


if __name__ == "__main__":
    main()
