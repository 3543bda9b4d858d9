"""Who sees whom: the lines of sight between all pairs of masts in a landscape, as a matrix.

    python line_of_sight.py [-o line_of_sight.png] [--masts 300] [--height 10] [landscape.obj]

A landscape or town of your own is to have z up; masts are as many of its units high as --height says.
"""

import argparse

import numpy as np

import kdray


def landscape(n=300, size=2000.0):
    x, y = np.meshgrid(np.linspace(0, size, n), np.linspace(0, size, n))
    z = 70 * np.sin(x / 210) * np.cos(y / 260) + 25 * np.sin(x / 90 + y / 140) + 12 * np.cos(x / 43) * np.sin(y / 51)
    i = np.arange(n * n).reshape(n, n)
    a, b, c, d = (corner.ravel() for corner in (i[:-1, :-1], i[:-1, 1:], i[1:, 1:], i[1:, :-1]))
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return np.stack([x, y, z], -1).reshape(-1, 3), triangles


def sees(scene, places):
    """(n, n) bool: whether nothing lies between two places; t is 0 at the one and 1 at the other."""
    origins = np.broadcast_to(places[:, None], (len(places), *places.shape))
    return ~scene.any_hit(origins, places - origins, t_max=1)  # a place and itself: no direction, so no hit


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", nargs="?", help="a landscape or town of your own")
    parser.add_argument("-o", "--output", default="line_of_sight.png")
    parser.add_argument("--masts", type=int, default=300)
    parser.add_argument("--height", type=float, default=10)
    parser.add_argument("--size", type=int, default=400, help="of each half of the picture, in pixels")
    args = parser.parse_args(argv)

    scene = kdray.load(args.mesh) if args.mesh else kdray.Scene()
    if not args.mesh:
        scene.add_mesh(*landscape())
    far = scene.closest_point(1e8 * np.vstack([np.eye(3), -np.eye(3)])).point  # the nearest are the scene's ends
    low, high = np.diag(far[3:]), np.diag(far[:3])

    # Masts stand on what is looked up from above.
    top = high[2] + 1
    above = np.random.default_rng(7).uniform([*low[:2], top], [*high[:2], top], (args.masts, 3))
    feet = scene.closest_hit(above, [0, 0, -1])
    masts = feet.point[feet.hit] + np.array([0, 0, args.height])
    if len(masts) < 2:
        parser.error("there is nothing to stand on: is z up?")
    matrix = sees(scene, masts)
    share = (matrix.sum(1) - 1) / (len(masts) - 1)
    best = np.argmax(share)
    print(f"{len(masts)} masts: {share.mean():.1%} of pairs see each other, {share[best]:.1%} the best")

    # On the left the landscape from above with the best mast's lines of sight, on the right the matrix.
    n, wide, middle = args.size, max((high - low)[:2]), (low + high) / 2
    camera = kdray.Camera([*middle[:2], top], [*middle[:2], low[2]], up=(0, 1, 0), ortho_width=wide)
    ground = scene.closest_hit(*kdray.pinhole_rays(camera, n, n, dtype=np.float64), fields=["normal"])
    left = np.repeat(np.clip(0.9 * ground.normal @ [-0.7, 0.6, 0.4], 0.03, 1)[..., None], 3, axis=2)

    def paint(at, rgb, size):
        column, row = ((at[:, :2] - middle[:2]) / wide * n + n / 2).astype(int).clip(0, n - 1).T
        for i, j in np.ndindex(size, size):
            left[np.minimum(n - 1 - row + i, n - 1), np.minimum(column + j, n - 1)] = rgb

    for seen in masts[matrix[best]]:
        paint(masts[best] + np.linspace(0, 1, 2 * n)[:, None] * (seen - masts[best]), [0.95, 0.5, 0.03], 1)
    paint(masts, [0.7, 0.02, 0.02], 3)
    paint(masts[matrix[best]], [1, 0.85, 0.2], 3)
    order = np.argsort(-share)[np.arange(n) * len(masts) // n]  # the masts that see most come first
    right = np.where(matrix[np.ix_(order, order)][..., None], [1, 0.8, 0.15], [0.02, 0.02, 0.1])
    kdray.Picture(np.concatenate([left, np.ones((n, 8, 3)), right], axis=1)).save(args.output)


if __name__ == "__main__":
    main()
