"""Blender: the panorama of `octagloss bake --target blender` lights a sphere in Cycles, on the CPU.

    pip install -r tests/consumers/blender.txt     PyPI's bpy, 374 MB, and the Python that it needs
    python tests/consumers/blender.py PROGRAM

The recipe of docs/engines.md sets up the world. Compares a white diffuse sphere with `query --lobe cosine`, a
mirror with `query --roughness 0`, and glossy spheres, where they face the viewer, with `query`; a panorama
that is rotated or mirrored must fail. The lamp of `--extract-sun` and the rest light a diffuse sphere as the
whole sky. Exit status 0 when all agree, 1 otherwise."""

import os
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix

from recipes import EYES, LABELLED, SUNNY, Checks, axes, query, recipe, relative, run, sphere, worst_channel

# Edge of the picture in pixels, rays a pixel, and the largest squared distance from the sphere's centre.
DIFFUSE_VIEW, MIRROR_VIEW, GLOSSY_VIEW = (32, 1024, 0.8), (128, 16, 0.8), (64, 512, 0.015)
# Noise of the diffuse light's samples; for the mirror hard edges of letters, averaged over pixels.
DIFFUSE, MIRROR = 0.03, 0.12
# The renderer's own lobe for light from ahead: near the centre it is the program's times masking, whose
# shape is narrower, the more the rougher.
# Diffuse spheres with the sun in the environment and as a lamp: greatest difference of a channel.
SUNLIT_VIEW, SUNLIT = (32, 4096, 0.8), 0.02
GLOSSY = {0.2: 0.05, 0.4: 0.07, 0.6: 0.1}


def in_blender(v):
    """glTF's axes in Blender's, as its importer turns them."""
    x, y, z = v
    return x, -z, y


def scene_with(panorama):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    here = os.getcwd()
    code = recipe("Blender", "python")
    assert "sky/sky_panorama.exr" in code, code
    exec(code.replace("//sky/sky_panorama.exr", str(panorama)), {})
    os.chdir(here)
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.max_bounces = 1
    scene.cycles.sample_clamp_indirect = 0
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", 2
    scene.camera = bpy.data.objects.new("camera", camera)
    scene.collection.objects.link(scene.camera)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1, segments=256, ring_count=128)
    bpy.ops.object.shade_smooth()
    return scene, bpy.context.object


def sunlit_by(sun):
    """Adds the lamp of the file `sun`."""
    code = recipe("Suns", "python")
    assert "//sky/sun.json" in code, code
    exec(code.replace("//sky/sun.json", str(sun)), {})


def material(kind, roughness):
    made = bpy.data.materials.new(kind)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    shader = nodes.new(f"ShaderNodeBsdf{kind}")
    shader.inputs["Color"].default_value = (1, 1, 1, 1)
    shader.inputs["Roughness"].default_value = roughness
    if kind == "Anisotropic":
        shader.distribution = "MULTI_GGX"
    output = nodes.new("ShaderNodeOutputMaterial")
    links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def picture(scene, ball, eye, surface, folder, view):
    """The sphere seen from `eye`, rows downwards; black outside what is compared."""
    right, up = axes(eye)
    size, scene.cycles.samples, most = view
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.use_border = True
    border = min(0.5, most**0.5 / 2 + 1 / size)
    scene.render.border_min_x = scene.render.border_min_y = 0.5 - border
    scene.render.border_max_x = scene.render.border_max_y = 0.5 + border
    columns = [in_blender(v) for v in (right, up, eye)]
    scene.camera.matrix_world = (
        Matrix.Translation([3 * v for v in in_blender(eye)])
        @ Matrix([[column[row] for column in columns] for row in range(3)]).to_4x4()
    )
    ball.data.materials.clear()
    ball.data.materials.append(surface)
    scene.render.filepath = str(folder / "picture.exr")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.array(image.pixels[:], np.float32).reshape(size, size, -1)[::-1, :, :3]
    bpy.data.images.remove(image)
    return pixels.astype(float)


def quietly(call):
    """Keeps the renderer's progress out of the output."""
    sys.stdout.flush()
    saved, null = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    try:
        return call()
    finally:
        sys.stdout.flush()
        os.dup2(saved, 1)
        os.close(saved)
        os.close(null)


def main(program):
    program = str(Path(program).resolve())
    checks = Checks()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        bakes = {"right": [], "rotated": ["--rotate-y", "90"], "mirrored": ["--mirror"]}
        for name, options in bakes.items():
            out = folder / name
            run(
                program,
                "bake",
                LABELLED,
                "--target",
                "blender",
                "--name",
                "sky",
                "-o",
                out,
                "--quiet",
                *options,
            )
        scene, ball = quietly(lambda: scene_with(folder / "right" / "sky_panorama.exr"))

        def worst(surface, eyes, view, directions, options):
            """The largest error of the pictures, by which of `normals` and `mirrored` is looked up."""
            errors = []
            for eye in eyes:
                step = max(1, round(view[0] * view[2] // 32))
                rows, columns, normals, mirrored = sphere(view[0], eye, step, view[2])
                exact = query(program, mirrored if directions == "mirrored" else normals, *options)
                shown = quietly(lambda: picture(scene, ball, eye, surface, folder, view))[rows, columns]
                errors.append(relative(shown, exact))
            return max(errors)

        def lookups(eyes):
            diffuse = worst(material("Diffuse", 0), eyes, DIFFUSE_VIEW, "normals", ["--lobe", "cosine"])
            options = ["--roughness", "0"]
            return diffuse, worst(material("Anisotropic", 0), eyes, MIRROR_VIEW, "mirrored", options)

        diffuse, mirror = lookups(EYES)
        checks.below(
            f"Blender {bpy.app.version_string}, Cycles, diffuse, {len(EYES)} views", diffuse, DIFFUSE
        )
        checks.below(f"Blender, mirror, {len(EYES)} views", mirror, MIRROR)
        for roughness, most in GLOSSY.items():
            # Within 7 degrees of facing the viewer.
            options = ["--roughness", str(roughness)]
            error = worst(material("Anisotropic", roughness), EYES, GLOSSY_VIEW, "mirrored", options)
            checks.below(
                f"Blender, GGX of roughness {roughness} seen from ahead, {len(EYES)} views", error, most
            )
        for name in ("rotated", "mirrored"):
            scene, ball = quietly(lambda: scene_with(folder / name / "sky_panorama.exr"))
            diffuse, mirror = lookups(EYES[-1:])
            checks.above(
                f"Blender, a panorama that is {name} is seen on the diffuse sphere", diffuse, 5 * DIFFUSE
            )
            checks.above(f"Blender, a panorama that is {name} is seen in the mirror", mirror, 0.3)

        for name, options in {"sun": [], "turned": ["--rotate-y", "20"]}.items():
            command = ["bake", SUNNY, "--target", "blender", "--extract-sun", "--name", "sky", "--quiet"]
            run(program, *command, "-o", folder / name, *options)

        def sunlit(name):
            """The largest error with the lamp of the bake `name`."""
            scene, ball = quietly(lambda: scene_with(folder / "sun" / "sky_panorama.exr"))
            sunlit_by(folder / name / "sun.json")
            errors = []
            for eye in EYES:
                rows, columns, normals, _ = sphere(SUNLIT_VIEW[0], eye, 2, SUNLIT_VIEW[2])
                exact = query(program, normals, "--lobe", "cosine", source=SUNNY)
                surface = material("Diffuse", 0)
                shown = quietly(lambda: picture(scene, ball, eye, surface, folder, SUNLIT_VIEW))
                errors.append(worst_channel(shown[rows, columns], exact))
            return max(errors)

        checks.below(f"Blender, the sun as a lamp, {len(EYES)} views, worst channel", sunlit("sun"), SUNLIT)
        checks.above("Blender, a lamp elsewhere is seen", sunlit("turned"), 4 * SUNLIT)
    return 1 if checks.failures else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    sys.exit(main(sys.argv[1]))
