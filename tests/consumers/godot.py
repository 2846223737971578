"""Godot 3: the panorama of `octagloss bake --target godot` as the sky of a scene, rendered under Xvfb.

    apt-get install godot3 xvfb libgl1-mesa-dri; pip install numpy
    python tests/consumers/godot.py PROGRAM

The recipe of docs/engines.md sets up the environment. Compares the sky and spheres of metal with `query`,
and a diffuse sphere with `query --lobe cosine`; the engine filters the panorama itself. A panorama that
is rotated or mirrored must fail. The lamp of `--extract-sun` lights a diffuse sphere by its irradiance. GODOT in the environment names the engine, by default godot3. Exit
status 0 when all agree, 1 otherwise."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from recipes import EYES, LABELLED, SUNNY, Checks, axes, query, recipe, relative, run, sphere

SIZE = 256
# The engine continues after an error of its script.
SECONDS = 300
# The engine's eight bits are of the radiance times this.
ENERGY = 0.25
# Relative errors by roughness: the engine's filter takes few samples of small levels.
METAL = {0.5: 0.15, 0.75: 0.12}
# The engine takes diffuse light from its roughest level of GGX.
DIFFUSE = 0.08
# A diffuse sphere in the light of a lamp alone: RMS difference of the worst channel over the brightest point.
LAMP = 0.02

PROJECT = """config_version=4
[application]
config/name="octagloss"
run/main_scene="res://main.tscn"
[rendering]
quality/driver/driver_name="GLES3"
environment/default_clear_color=Color(0, 0, 0, 1)
"""

SCENE = """[gd_scene load_steps=3 format=2]
[ext_resource path="res://main.gd" type="Script" id=1]
[sub_resource type="World" id=2]
[node name="view" type="Viewport"]
size = Vector2(SIZE, SIZE)
world = SubResource( 2 )
render_target_update_mode = 3
[node name="main" type="Spatial" parent="."]
script = ExtResource( 1 )
"""

SCRIPT = """extends Spatial

# Lines of the jobs: metal, diffuse, sky or lamp, the roughness, the eye, right and up of the view.
func _ready():
RECIPE
SUNS
	lamp.light_energy *= ENERGY
	var camera = Camera.new()
	camera.near = 0.1
	camera.far = 10.0
	add_child(camera)
	camera.current = true
	var ball = MeshInstance.new()
	ball.mesh = SphereMesh.new()
	ball.mesh.radius = 1.0
	ball.mesh.height = 2.0
	ball.mesh.radial_segments = 128
	ball.mesh.rings = 64
	var material = SpatialMaterial.new()
	ball.material_override = material
	add_child(ball)
	var jobs = File.new()
	jobs.open("res://jobs.txt", File.READ)
	while not jobs.eof_reached():
		var words = jobs.get_line().split(" ")
		if words.size() < 12:
			continue
		var n = []
		for k in range(2, 12):
			n.append(float(words[k]))
		ball.visible = words[0] != "sky"
		material.metallic = 1.0 if words[0] == "metal" else 0.0
		material.metallic_specular = 0.5 if words[0] == "metal" else 0.0
		material.roughness = float(words[1])
		lamp.visible = words[0] == "lamp"
		environment.background_energy = 0.0 if words[0] == "lamp" else ENERGY
		material.params_diffuse_mode = SpatialMaterial.DIFFUSE_LAMBERT
		var eye = Vector3(n[1], n[2], n[3])
		var right = Vector3(n[4], n[5], n[6])
		var up = Vector3(n[7], n[8], n[9])
		camera.transform = Transform(right, up, eye, 3.0 * eye)
		if words[0] == "sky":
			camera.set_perspective(90.0, 0.1, 10.0)
		else:
			camera.set_orthogonal(2.0, 0.1, 10.0)
		# The sky's levels are filtered in the first frame.
		for frame in range(3):
			yield(VisualServer, "frame_post_draw")
		var picture = get_viewport().get_texture().get_data()
		picture.convert(Image.FORMAT_RGB8)
		var out = File.new()
		out.open("res://%d.rgb" % int(n[0]), File.WRITE)
		out.store_buffer(picture.get_data())
		out.close()
	get_tree().quit()
"""


def pictures(engine, folder, panorama, sun, jobs):
    """Pictures of `jobs` (subject, roughness, eye), linear radiance, rows downwards."""
    folder.mkdir()
    (folder / "sky").mkdir()
    shutil.copy(panorama, folder / "sky" / "sky_panorama.exr")
    shutil.copy(sun, folder / "sky" / "sun.json")
    code = recipe("Godot", "gdscript")
    assert "res://sky/sky_panorama.exr" in code, code
    # On the CPU the engine's filter takes minutes for its finer levels.
    assert "RADIANCE_SIZE_256" in code, code
    code = code.replace("RADIANCE_SIZE_256", "RADIANCE_SIZE_64")
    suns = recipe("Suns", "gdscript").replace("    ", "\t")
    assert "res://sky/sun.json" in suns, suns
    indented = {"RECIPE": code, "SUNS": suns}
    script = SCRIPT
    for word, text in indented.items():
        script = script.replace(word, "".join(f"\t{line}\n" for line in text.splitlines()))
    (folder / "project.godot").write_text(PROJECT)
    (folder / "main.tscn").write_text(SCENE.replace("SIZE", str(SIZE)))
    (folder / "main.gd").write_text(script.replace("ENERGY", str(ENERGY)))
    lines = []
    for number, (subject, roughness, eye) in enumerate(jobs):
        right, up = axes(eye)
        lines.append(" ".join(map(str, (subject, roughness, number, *eye, *right, *up))))
    (folder / "jobs.txt").write_text("\n".join(lines) + "\n")
    screen = ["xvfb-run", "-a", "-s", "-screen 0 640x480x24", "timeout", str(SECONDS)]
    command = [*screen, engine, "--path", folder, "--audio-driver", "Dummy"]
    done = subprocess.run(command, capture_output=True, text=True)
    shown = []
    for number in range(len(jobs)):
        path = folder / f"{number}.rgb"
        if not path.exists():
            raise SystemExit(f"{engine} drew no picture {number}:\n{done.stdout}{done.stderr}")
        codes = np.frombuffer(path.read_bytes(), np.uint8).reshape(SIZE, SIZE, 3) / 255
        # Render targets have their first row below.
        linear = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
        shown.append(linear[::-1] / ENERGY)
    return shown


def sky(eye, step):
    """Pixels of a view of 90 degrees from the centre, away from `eye`: rows, columns and directions."""
    right, up = axes(eye)
    rows, columns = (
        grid.ravel() for grid in np.meshgrid(*[np.arange(step // 2, SIZE, step)] * 2, indexing="ij")
    )
    x, y = (2 * columns + 1) / SIZE - 1, 1 - (2 * rows + 1) / SIZE
    directions = x[:, None] * right + y[:, None] * up - np.array(eye, float)
    return rows, columns, directions / np.linalg.norm(directions, axis=1)[:, None]


def error(program, job, shown, sun):
    subject, roughness, eye = job
    if subject == "lamp":
        sun = json.loads(sun.read_text())
        rows, columns, normals, _ = sphere(SIZE, eye, 12)
        cosines = np.maximum(normals @ sun["direction"], 0)[:, None]
        greatest = np.array(sun["irradiance"]) / np.pi
        # Of a side that is all dark as well.
        difference = np.sqrt(((shown[rows, columns] - cosines * greatest) ** 2).mean(0))
        return float((difference / greatest).max())
    if subject == "sky":
        rows, columns, directions = sky(eye, 8)
        return relative(shown[rows, columns], query(program, directions, "--roughness", "0"))
    rows, columns, normals, mirrored = sphere(SIZE, eye, 12)
    if subject == "diffuse":
        return relative(shown[rows, columns], query(program, normals, "--lobe", "cosine"))
    # The engine's fit of a white metal's reflectance, for any view.
    exact = (1 - 0.55 * roughness) * query(program, mirrored, "--roughness", str(roughness))
    return relative(shown[rows, columns], exact)


def main(program):
    program = str(Path(program).resolve())
    engine = os.environ.get("GODOT", "godot3")
    checks = Checks()
    tolerances = {("sky", 0.0): 0.12, ("diffuse", 1.0): DIFFUSE, ("lamp", 1.0): LAMP}
    tolerances.update({("metal", roughness): most for roughness, most in METAL.items()})
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        bakes = {"right": [], "rotated": ["--rotate-y", "90"], "mirrored": ["--mirror"]}
        for name, options in bakes.items():
            out = folder / f"bake-{name}"
            run(
                program,
                "bake",
                LABELLED,
                "--target",
                "godot",
                "--name",
                "sky",
                "-o",
                out,
                "--quiet",
                *options,
            )
            sunny = ["--target", "godot", "--extract-sun", "--quiet", "-o", folder / f"sun-{name}"]
            run(program, "bake", SUNNY, *sunny, *options)
            sun = folder / f"sun-{name}" / "sun.json"
            eyes = EYES if name == "right" else EYES[-1:]
            jobs = [(*subject, eye) for subject in tolerances for eye in eyes]
            shown = pictures(engine, folder / name, out / "sky_panorama.exr", sun, jobs)
            errors = {subject: 0 for subject in tolerances}
            for job, picture in zip(jobs, shown):
                errors[job[:2]] = max(errors[job[:2]], error(program, job, picture, folder / "sun-right" / "sun.json"))
            for (subject, roughness), value in errors.items():
                what = f"Godot, {subject}, roughness {roughness}, {len(eyes)} views"
                most = tolerances[subject, roughness]
                if name == "right":
                    checks.below(what, value, most)
                else:
                    checks.above(f"{what}, a light that is {name} is seen", value, 1.5 * most)
    return 1 if checks.failures else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    sys.exit(main(sys.argv[1]))
