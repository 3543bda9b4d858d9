"""Hours of sun on the walls, roofs and streets of a city block, over one day.

    python sun_hours.py [-o sun_hours.png] [--date 2025-03-20] [--latitude 55.7] [--longitude 12.6] [town.obj]

A town of your own is to have x east, y north, z up, and metres.
"""

import argparse

import numpy as np

import kdray


def sun(times, latitude, longitude):
    """Unit vectors (east, north, up) to the sun at UTC times (datetime64); latitude and longitude in degrees.

    The Astronomical Almanac's low-precision formulas (page C5; 0.01 degrees from 1950 to 2050), with the US
    Naval Observatory's approximate sidereal time. Refraction, half a degree at sunset, is left out.
    """
    d = (times - np.datetime64("2000-01-01T12:00")) / np.timedelta64(1, "D")  # days since J2000.0
    g = np.radians(357.528 + 0.9856003 * d)  # mean anomaly
    ecliptic = np.radians(280.460 + 0.9856474 * d + 1.915 * np.sin(g) + 0.020 * np.sin(2 * g))
    tilt = np.radians(23.439 - 0.0000004 * d)
    ascension = np.arctan2(np.cos(tilt) * np.sin(ecliptic), np.cos(ecliptic))
    declination = np.arcsin(np.sin(tilt) * np.sin(ecliptic))
    hour = np.radians(15 * (18.697374558 + 24.06570982441908 * d) + longitude) - ascension
    p, s, c = np.radians(latitude), np.sin(declination), np.cos(declination)
    north, up = np.cos(p) * s - np.sin(p) * c * np.cos(hour), np.sin(p) * s + np.cos(p) * c * np.cos(hour)
    return np.stack([-c * np.sin(hour), north, up], -1)


def sun_hours(scene, points, normals, suns, hours_each):
    """How long the sun shines on each point, as a meter sees it that hangs a centimetre off its wall."""
    hours, meters = np.zeros(len(points)), points + 0.01 * normals
    for to_sun in suns[suns[:, 2] > 0]:  # above the horizon
        faced = np.flatnonzero(normals @ to_sun > 0)
        hours[faced] += np.where(scene.any_hit(meters[faced], to_sun), 0, hours_each)
    return hours


def box(scene, x, y, wide, deep, tall, floor=0):
    corners = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)]) * [wide, deep, tall] + [x, y, floor]
    quads = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
    scene.add_mesh(corners, np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]))


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mesh", nargs="?", help="a town of your own")
    parser.add_argument("-o", "--output", default="sun_hours.png")
    parser.add_argument("--date", default="2025-03-20")
    parser.add_argument("--latitude", type=float, default=55.7)
    parser.add_argument("--longitude", type=float, default=12.6)
    parser.add_argument("--minutes", type=int, default=10, help="between two looks at the sun")
    parser.add_argument("--width", type=int, default=800)
    args = parser.parse_args(argv)

    scene = kdray.load(args.mesh) if args.mesh else kdray.Scene()
    if not args.mesh:
        box(scene, -85, -75, 170, 160, tall=1, floor=-1)  # the ground
        for i in range(20):
            tall = 60 if i == 7 else 9 + 3 * (i * 7 % 5)
            box(scene, 30 * (i % 5) - 70, 32 * (i // 5) - 60, 14 if i % 3 else 20, 20, tall)
    far = scene.closest_point(1e8 * np.vstack([np.eye(3), -np.eye(3)])).point  # the nearest are the scene's ends
    low, high = np.diag(far[3:]), np.diag(far[:3])
    middle = (low + high) / 2 * [1, 1, 0.1]
    eye = middle + np.linalg.norm(high - low) * np.array([0.38, -0.75, 0.75])
    camera = kdray.Camera(eye, middle, up=(0, 0, 1), fov=36)
    seen = scene.closest_hit(*kdray.pinhole_rays(camera, args.width, args.width * 5 // 8, dtype=np.float64))

    noon = np.datetime64(args.date) + np.timedelta64(round(43200 - 240 * args.longitude), "s")
    minutes = np.arange(-720, 720, args.minutes).astype("timedelta64[m]")
    suns = sun(noon + minutes, args.latitude, args.longitude)
    points, normals = seen.point[seen.hit], seen.normal[seen.hit]
    hours = sun_hours(scene, points, normals, suns, args.minutes / 60)
    day = np.count_nonzero(suns[:, 2] > 0) * args.minutes / 60
    print(f"{args.date}: {day:.1f} h between sunrise and sunset, {np.median(hours):.1f} h at the median point")

    stops = ([0.02, 0.15, 0.7, 0.95, 1], [0.02, 0.02, 0.08, 0.4, 0.9], [0.1, 0.25, 0.12, 0.05, 0.5])
    colour = np.stack([np.interp(hours / day, [0, 0.25, 0.5, 0.75, 1], values) for values in stops], -1)
    pixels = np.full((*seen.hit.shape, 3), 0.8)
    pixels[seen.hit] = colour * (0.75 + 0.25 * np.abs(normals @ [0.3, -0.5, 0.8]))[:, None]  # so that edges show
    kdray.Picture(pixels).save(args.output)


if __name__ == "__main__":
    main()
