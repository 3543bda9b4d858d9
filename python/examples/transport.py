"""Particles that scatter through nested volumes: where they fly, where they are absorbed, how many leave.

    python transport.py [-o transport.png] [--particles 200000] [core.stl]

A core that sends out particles, in a ball of shielding, in a tank. Each surface has a volume on either side, and a ray
leaves the one inside where it goes along the normal. A core of your own is to be closed, its sides outwards, and within
2 of the origin.
"""

import argparse

import numpy as np

import kdray

OUTSIDE, TANK, SHIELD, CORE = range(4)
NAMES = ["outside", "tank", "shield", "core"]
TOTAL = np.array([0, 0.2, 1.5, 0.8])  # collisions per length
ABSORBED = np.array([0, 0.05, 0.5, 0.1])  # the share of collisions that absorb


def isotropic(rng, n):
    d = rng.normal(size=(n, 3))
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def walk(scene, sides, points, volume, total, absorbed, rng):
    """Flies particles from the points until each is absorbed or outside.

    sides holds the volume inside and the one outside of each geometry. Returns the length that was flown in each
    volume, the number absorbed in each, the number lost, and the points of all collisions. A particle is lost where
    the next surface isn't one of its volume: volumes that overlap or are open, a ray that touches an edge exactly.
    """
    t, directions = np.zeros(len(points)), isotropic(rng, len(points))
    flown, ends, lost, collisions = np.zeros(len(total)), np.zeros(len(total), int), 0, []
    while len(points):
        free = rng.exponential(size=len(points)) / np.maximum(total[volume], 1e-30)
        hits = scene.closest_hit(points, directions, t_min=t, fields=["t", "geometry", "normal"])
        far = ((hits.normal * directions).sum(1) > 0).astype(int)  # 1: the ray goes outwards
        good = hits.hit & (sides[hits.geometry, 1 - far] == volume)
        lost += np.count_nonzero(~good)
        crosses, collides = good & (hits.t <= t + free), good & (hits.t > t + free)
        end = np.where(good, np.minimum(hits.t, t + free), t)
        np.add.at(flown, volume, end - t)
        volume = np.where(crosses, sides[hits.geometry, far], volume)

        places = points + directions * end[:, None]
        collisions.append(places[collides])
        stops = collides & (rng.random(len(points)) < absorbed[volume])
        np.add.at(ends, volume[stops], 1)

        # At a surface the same ray goes on: from the hit's own t it finds what comes after just that hit.
        points, t = np.where(collides[:, None], places, points), np.where(collides, 0, end)
        directions = np.where(collides[:, None], isotropic(rng, len(points)), directions)
        on = good & ~stops & (volume != OUTSIDE)
        points, directions, t, volume = points[on], directions[on], t[on], volume[on]
    return flown, ends, lost, np.concatenate(collisions)


def volume_of(scene, sides, points):
    """The volume that holds each point: a side of the first surface in any direction."""
    towards = np.array([0.36, 0.48, 0.8])
    hits = scene.closest_hit(points, towards, fields=["geometry", "normal"])
    return np.where(hits.hit, sides[hits.geometry, (hits.normal @ towards < 0).astype(int)], OUTSIDE)


def box(size):
    """Vertices and triangles of a cube whose sides point outwards."""
    corners = [[(i >> axis & 1) - 0.5 for axis in range(3)] for i in range(8)]
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return size * np.array(corners), [t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])]


def points_in(scene, sides, volume, n, rng):
    """Points spread evenly in a volume: thrown into the shield's cube, and kept if they are in it."""
    found = np.empty((0, 3))
    while len(found) < n:
        thrown = rng.uniform(-2, 2, (100000, 3))
        found = np.concatenate([found, thrown[volume_of(scene, sides, thrown) == volume]])
        if len(found) == 0:
            raise SystemExit("none of 100,000 points is in the core: is it closed, and within 2 of the origin?")
    return found[:n]


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", nargs="?", help="a core of your own")
    parser.add_argument("-o", "--output", default="transport.png")
    parser.add_argument("--particles", type=int, default=200000)
    parser.add_argument("--size", type=int, default=400, help="of the picture, in pixels")
    args = parser.parse_args(argv)
    if args.particles < 1:
        parser.error(f"--particles {args.particles}: at least one")

    scene = kdray.load(args.mesh) if args.mesh else kdray.Scene()
    if not args.mesh:
        scene.add_tori([[0, 0, 0]], [[0, 0, 1]], [1.2], [0.4])
    scene.add_spheres([[0, 0, 0]], [2])
    scene.add_mesh(*box(8))
    sides = np.array([[CORE, SHIELD], [SHIELD, TANK], [TANK, OUTSIDE]])  # inside and outside of each geometry

    rng = np.random.default_rng(5)
    source = points_in(scene, sides, CORE, args.particles, rng)
    flown, ends, lost, collisions = walk(scene, sides, source, np.full(len(source), CORE), TOTAL, ABSORBED, rng)
    for volume in (CORE, SHIELD, TANK):
        print(f"{NAMES[volume]:7} {ends[volume] / len(source):6.1%} absorbed, {flown[volume] / len(source):.3f} flown")
    left = len(source) - ends.sum() - lost
    print(f"{left / len(source):.1%} leave, {lost} are lost; {len(collisions) / len(source):.2f} collisions each")

    # How often particles collide in the slab about z = 0, on a scale of logarithms.
    slab = collisions[np.abs(collisions[:, 2]) < 0.5, :2]
    n = np.histogram2d(-slab[:, 1], slab[:, 0], bins=args.size // 4, range=[[-4, 4], [-4, 4]])[0]
    shade = np.kron(np.log1p(n) / np.log1p(max(n.max(), 1)), np.ones((4, 4)))
    stops = ([0.01, 0.25, 0.9, 1], [0.01, 0.05, 0.4, 0.95], [0.03, 0.3, 0.05, 0.7])
    rgb = [np.interp(shade, [0, 0.4, 0.75, 1], values) for values in stops]
    kdray.Picture(np.stack(rgb, -1)).save(args.output)


if __name__ == "__main__":
    main()
