#!/usr/bin/env python3
"""Writes the meshes of scenes/meshes from their formulas (Python 3 alone; the same bytes on every run).

    scripts/make_meshes.py [FOLDER]        default: scenes/meshes beside this script's folder

  knot.ply      a (2, 3) torus knot, quads with smooth normals, binary PLY
  star.obj      a supershape (J. Gielis, "A generic geometric transformation", Am. J. Botany 90, 2003), smooth OBJ
  hills.ply     a low-poly landscape, flat triangles, ASCII PLY
  bead.obj      a rippled bead of 168 triangles with smooth normals
  gem.ply       a cut stone of 48 flat triangles, closed
All are y-up and fit the cube from -1 to 1, the landscape apart: it lies on y = 0 and is 2 by 1.
"""

import math
import pathlib
import struct
import sys


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    length = math.sqrt(dot(a, a))
    return [x / length for x in a]


def fit(points):
    """Scales about the origin until the largest coordinate is 1."""
    largest = max(abs(x) for p in points for x in p)
    return [[x / largest for x in p] for p in points]


def vertex_normals(points, faces):
    """Normals averaged over the faces around a vertex, weighted by their area."""
    sums = [[0.0, 0.0, 0.0] for _ in points]
    for face in faces:
        a, b, c = (points[face[i]] for i in (0, 1, 2))
        normal = cross(sub(b, a), sub(c, a))
        if len(face) == 4:
            normal = cross(sub(c, a), sub(points[face[3]], b))  # of the two diagonals
        for v in face:
            sums[v] = [s + n for s, n in zip(sums[v], normal)]
    return [unit(s) for s in sums]


def knot(around=140, across=16, thickness=0.42):
    """The tube's cross sections stand on the curve's tangent, turned as little as possible from one to the next."""

    def center(t):
        r = 2 + math.cos(3 * t)
        return [r * math.cos(2 * t), r * math.sin(2 * t), 1.1 * math.sin(3 * t)]

    centers = [center(2 * math.pi * i / around) for i in range(around)]
    tangents = [unit(sub(centers[(i + 1) % around], centers[i - 1])) for i in range(around)]
    normals = [unit(cross(tangents[0], [0, 0, 1]))]
    for i in range(1, around + 1):
        t = tangents[i % around]
        n = normals[-1]
        normals.append(unit(sub(n, [dot(n, t) * x for x in t])))
    # What the transport is off by after one round is spread over all sections, so that the tube closes.
    t, n = tangents[0], normals[0]
    off = math.atan2(dot(normals[-1], cross(t, n)), dot(normals[-1], n))
    points = []
    for i in range(around):
        n = normals[i]
        b = cross(tangents[i], n)
        for k in range(across):
            a = 2 * math.pi * k / across - off * i / around
            points.append([c + thickness * (math.cos(a) * x + math.sin(a) * y) for c, x, y in zip(centers[i], n, b)])
    quads = []
    for i in range(around):
        for k in range(across):
            j, m = (i + 1) % around, (k + 1) % across
            quads.append([i * across + k, i * across + m, j * across + m, j * across + k])
    return fit(points), quads


def grid_of_revolution(radius, around, rows):
    """A closed surface from radius(longitude, latitude), poles on the y axis, counter-clockwise from outside."""
    top, bottom = radius(0.0, math.pi / 2), radius(0.0, -math.pi / 2)
    points = [[0.0, top, 0.0]]
    for r in range(1, rows):
        latitude = math.pi / 2 - math.pi * r / rows
        for i in range(around):
            longitude = 2 * math.pi * i / around
            d = radius(longitude, latitude)
            points.append([d * math.cos(latitude) * math.sin(longitude), d * math.sin(latitude),
                           d * math.cos(latitude) * math.cos(longitude)])
    points.append([0.0, -bottom, 0.0])
    last = len(points) - 1
    faces = []
    for i in range(around):
        j = (i + 1) % around
        faces.append([0, 1 + i, 1 + j])
        for r in range(rows - 2):
            upper, lower = 1 + r * around, 1 + (r + 1) * around
            faces.append([upper + i, lower + i, lower + j, upper + j])
        foot = 1 + (rows - 2) * around
        faces.append([foot + i, last, foot + j])
    return points, faces


def superformula(angle, m, n1, n2, n3):
    return (abs(math.cos(m * angle / 4)) ** n2 + abs(math.sin(m * angle / 4)) ** n3) ** (-1 / n1)


def star(around=50, rows=20):
    """Five rounded lobes round the y axis, which fade towards the poles."""

    def radius(longitude, latitude):
        return 1 + (superformula(longitude, 5, 1.4, 4, 4) - 1) * math.cos(latitude)

    points, faces = grid_of_revolution(radius, around, rows)
    return fit(points), faces


def bead():
    points, faces = grid_of_revolution(lambda lon, lat: 1 + 0.12 * math.cos(4 * lon) * math.cos(lat) ** 2, 12, 8)
    return fit(points), triangles_of(faces)


def gem(sides=8):
    """Table, crown, girdle and pavilion; the girdle's corners sit between the table's."""
    table = [[0.55 * math.sin(a), 0.45, 0.55 * math.cos(a)] for a in (2 * math.pi * i / sides for i in range(sides))]
    girdle = [[math.sin(a), 0.1, math.cos(a)] for a in (2 * math.pi * (i + 0.5) / sides for i in range(sides))]
    belt = [[x, -0.02, z] for x, _, z in girdle]
    points = table + girdle + belt + [[0, 0.45, 0], [0, -0.95, 0]]
    center, tip = 3 * sides, 3 * sides + 1
    faces = []
    for i in range(sides):
        j = (i + 1) % sides
        g, h, b, c = sides + i, sides + j, 2 * sides + i, 2 * sides + j
        faces += [[center, i, j], [i, g, j], [j, g, h], [g, b, h], [h, b, c], [b, tip, c]]
    return points, faces


def hills(columns=44, rows=20):
    """Ridges of a few waves that rise towards the back (z = -1), with a jitter that is a fixed hash of the place."""

    def jitter(i, k, salt):
        h = (i * 73856093 ^ k * 19349663 ^ salt * 83492791) & 0xFFFFFFFF
        h = (h ^ (h >> 13)) * 1274126177 & 0xFFFFFFFF
        return (h >> 8) / 0xFFFFFF - 0.5

    points = []
    for k in range(rows + 1):
        for i in range(columns + 1):
            inside = 0 < i < columns and 0 < k < rows
            x = -1 + 2 * (i + (0.6 * jitter(i, k, 1) if inside else 0)) / columns
            z = -(k + (0.6 * jitter(i, k, 2) if inside else 0)) / rows
            wave = 1.1 + math.sin(5.1 * x + 1.3) * math.cos(3.3 * z) + 0.5 * math.sin(11 * x - 7 * z) + 0.7 * jitter(i, k, 3)
            y = 0.16 * max(wave, 0.35) * (-z) ** 1.3
            points.append([x, y, z])
    faces = []
    for k in range(rows):
        for i in range(columns):
            a = k * (columns + 1) + i
            b, c, d = a + 1, a + columns + 1, a + columns + 2
            faces += [[a, b, d], [a, d, c]] if (i + k) % 2 else [[a, b, c], [b, d, c]]
    return points, faces


def triangles_of(faces):
    return [[f[0], f[i], f[i + 1]] for f in faces for i in range(1, len(f) - 1)]


def write_binary_ply(file, comment, points, faces):
    normals = vertex_normals(points, faces)
    head = ["ply", "format binary_little_endian 1.0", "comment " + comment, f"element vertex {len(points)}"]
    head += [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
    head += [f"element face {len(faces)}", "property list uchar ushort vertex_indices", "end_header"]
    data = bytearray(("\n".join(head) + "\n").encode())
    for p, n in zip(points, normals):
        data += struct.pack("<6f", *p, *n)
    for f in faces:
        data += struct.pack(f"<B{len(f)}H", len(f), *f)
    file.write_bytes(data)


def write_ascii_ply(file, comment, points, faces):
    lines = ["ply", "format ascii 1.0", "comment " + comment, f"element vertex {len(points)}"]
    lines += [f"property float {name}" for name in ("x", "y", "z")]
    lines += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(f"{x:.5g}" for x in p) for p in points]
    lines += [" ".join(str(i) for i in [len(f)] + f) for f in faces]
    file.write_text("\n".join(lines) + "\n")


def write_obj(file, comment, points, faces):
    lines = ["# " + comment]
    lines += ["v " + " ".join(f"{x:.5f}" for x in p) for p in points]
    lines += ["vn " + " ".join(f"{x:.4f}" for x in n) for n in vertex_normals(points, faces)]
    lines += ["f " + " ".join(f"{i + 1}//{i + 1}" for i in f) for f in faces]
    file.write_text("\n".join(lines) + "\n")


def main():
    here = pathlib.Path(__file__).resolve().parent.parent
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else here / "scenes" / "meshes"
    folder.mkdir(parents=True, exist_ok=True)
    by = "made by kdray's scripts/make_meshes.py"
    write_binary_ply(folder / "knot.ply", "torus knot, " + by, *knot())
    write_obj(folder / "star.obj", "supershape, " + by, *star())
    write_ascii_ply(folder / "hills.ply", "landscape, " + by, *hills())
    write_obj(folder / "bead.obj", "rippled bead, " + by, *bead())
    write_ascii_ply(folder / "gem.ply", "cut stone, " + by, *gem())


if __name__ == "__main__":
    main()
