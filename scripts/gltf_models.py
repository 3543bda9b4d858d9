#!/usr/bin/env python3
"""Renders the glTF test models of docs/gltf-models.md and writes their small pictures (Python 3 alone).

    scripts/gltf_models.py KDRAY DATA [FOLDER]        default: docs/images/gltf beside this script's folder

KDRAY is the program, DATA the folder with the models (shared/data/gltf). One PNG of 128 x 128 pixels for each model,
by 16 samples, named as the model is; what kdray says of a model is printed. A model that is not there is skipped.
Pictures are the same bytes on every machine, so a difference that `git diff` tells of is kdray's.
Errors: status 1 where kdray refuses a model.
"""

import json
import pathlib
import subprocess
import sys

# Beside the name: the file, and whether it is seen straight from the front (else by the file's camera, or from above
# one corner).
MODELS = {
    "2CylinderEngine": ("2CylinderEngine.glb", ""),
    "2CylinderEngine-draco": ("2CylinderEngine_draco/2CylinderEngine.gltf", ""),
    "AlphaBlendModeTest": ("trimesh/AlphaBlendModeTest.glb", "front"),
    "AnimatedMorphCube": ("AnimatedMorphCube/AnimatedMorphCube.gltf", ""),
    "Box": ("Box.glb", ""),
    "Box-draco": ("Box_Draco.glb", ""),
    "BoxInterleaved": ("trimesh/BoxInterleaved.glb", ""),
    "BoxTexcoords": ("BoxTexcoords-glTF/boxTexcoords.gltf", ""),
    "BoxTextured": ("BoxTextured/BoxTextured.gltf", ""),
    "Cameras": ("cameras/Cameras.gltf", ""),
    "ClearCoatTest": ("ClearCoat-glTF/ClearCoatTest.gltf", "front"),
    "Cube": ("Cube/Cube.gltf", ""),
    "CubeImageUriSpaces": ("CubeImageUriSpaces/CubeImageUriSpaces.gltf", ""),
    "DamagedHelmet": ("DamagedHelmet.glb", ""),
    "Duck": ("Duck/Duck.gltf", ""),
    "SimpleSparseAccessor": ("SimpleSparseAccessor/SimpleSparseAccessor.gltf", "front"),
    "SpheresScaledInstances": ("SpheresScaledInstances/spheres_scaled_instances.gltf", ""),
    "TestScene": ("trimesh/TestScene.gltf", ""),
    "TextureSettingsTest": ("TextureSettingsTest/TextureSettingsTest.gltf", "front"),
    "TextureTransformTest": ("TextureTransformTest/TextureTransformTest.gltf", "front"),
    "Triangle": ("Triangle/Triangle.gltf", "front"),
    "TwoSidedPlane": ("TwoSidedPlane/TwoSidedPlane.gltf", ""),
    "UnlitTest": ("UnlitTest/UnlitTest.gltf", ""),
    "VertexColorTest": ("VertexColorTest/VertexColorTest.gltf", "front"),
    "cubevc": ("trimesh/cubevc.glb", ""),
    "mode5": ("trimesh/mode5.gltf", ""),
    "monkey": ("trimesh/monkey.glb", ""),
    "nested": ("trimesh/nested.glb", ""),
    "no_indices_3storybuilding": ("trimesh/no_indices_3storybuilding.glb", ""),
    "pbr_next_sphere": ("pbr_next_sphere/sphere.gltf", ""),
    "sphere_lights": ("sphere_lights/sphere_lights.gltf", ""),
}


def from_the_front(kdray, model):
    """Options of a camera at +z without perspective that has the model's bounds in its picture."""
    told = subprocess.run([kdray, "info", "--json", model], check=True, capture_output=True, text=True)
    bounds = json.loads(told.stdout)["bounds"]
    x, y, _ = ((a + b) / 2 for a, b in zip(bounds["min"], bounds["max"]))
    width = 1.1 * max(b - a for a, b in list(zip(bounds["min"], bounds["max"]))[:2])
    z = bounds["max"][2]
    return ["--from", f"{x},{y},{z + width}", "--at", f"{x},{y},{z}", "--ortho", str(width)]


def render(kdray, model, picture, view):
    """Writes the picture; the lines that kdray says are warnings, or why there is none."""
    options = ["--size", "128x128", "--samples", "16", "-q", "-o", str(picture)]
    view_options = from_the_front(kdray, model) if view == "front" else []
    command = [kdray, "render", model, "--look", "plain", *options, *view_options]
    done = subprocess.run(command, capture_output=True, text=True)
    for line in done.stderr.splitlines():
        print(f"  {line.removeprefix('kdray: ').removeprefix(model + ': ')}")
    return done.returncode


def main():
    if len(sys.argv) not in (3, 4):
        sys.exit("usage: gltf_models.py KDRAY DATA [FOLDER]")
    kdray, data = sys.argv[1], pathlib.Path(sys.argv[2])
    here = pathlib.Path(__file__).resolve().parent.parent
    folder = pathlib.Path(sys.argv[3]) if len(sys.argv) == 4 else here / "docs/images/gltf"
    folder.mkdir(parents=True, exist_ok=True)
    status = 0
    for name, (file, view) in MODELS.items():
        model = data / file
        if not model.exists():
            print(f"{name}: not there")
            continue
        print(name)
        if render(kdray, str(model), folder / f"{name}.png", view) != 0:
            status = 1
    sys.exit(status)


if __name__ == "__main__":
    main()
