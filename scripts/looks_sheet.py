#!/usr/bin/env python3
"""Renders models in both looks and writes docs/images/looks.png (needs Pillow).

    scripts/looks_sheet.py KDRAY DATA [PICTURE]        default: docs/images/looks.png beside this script's folder

KDRAY is the program, DATA the folder with the models (shared/data). Each model is there twice, --look plain above
--look studio, 128 x 128 pixels by 64 samples, so that the sheet stays small. A model that is not there is left black.
"""

import pathlib
import subprocess
import sys
import tempfile

from PIL import Image

SIDE, COLUMNS = 128, 7
MODELS = [
    "stanford/dragon_100k.ply.xz",
    "stanford/lucy_20k.ply.xz",
    "gltf/DamagedHelmet.glb",
    "stanford/spot.obj.xz",
    "stanford/teapot.obj.xz",
    "stanford/beetle-alt.obj.xz",
    "stanford/armadillo_86k.ply.xz",
    "stanford/bunny_zipper.ply.xz",
    "gltf/trimesh/monkey.glb",
    "gltf/2CylinderEngine.glb",
    "interior/cornell/CornellBox-Sphere.obj.xz",
    "interior/dabrovic_sponza/sponza.obj.xz",
    "interior/classroom/classroom.obj.xz",
    "interior/conference/conference.ply.xz",
]


def picture(kdray, model, look, folder):
    """The model in that look, or black where it is not there."""
    if not model.exists():
        return Image.new("RGB", (SIDE, SIDE))
    out = pathlib.Path(folder) / "out.png"
    options = ["--look", look, "--size", f"{SIDE}x{SIDE}", "--samples", "64", "-q", "-o", str(out)]
    subprocess.run([kdray, "render", str(model), *options], check=True)
    return Image.open(out).convert("RGB")


def main():
    kdray, data = sys.argv[1], pathlib.Path(sys.argv[2])
    here = pathlib.Path(__file__).resolve().parent.parent
    target = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else here / "docs/images/looks.png"
    rows = -(-len(MODELS) // COLUMNS)
    sheet = Image.new("RGB", (COLUMNS * SIDE, 2 * rows * SIDE))
    with tempfile.TemporaryDirectory() as folder:
        for i, name in enumerate(MODELS):
            for k, look in enumerate(("plain", "studio")):
                at = (i % COLUMNS * SIDE, (2 * (i // COLUMNS) + k) * SIDE)
                sheet.paste(picture(kdray, data / name, look, folder), at)
    sheet.quantize(255, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE).save(target, optimize=True)


if __name__ == "__main__":
    main()
