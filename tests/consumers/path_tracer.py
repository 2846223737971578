"""Cycles: a path tracer confirms `octagloss query --frames`, sphere by sphere, on the CPU.

    pip install -r tests/consumers/blender.txt     PyPI's bpy, 374 MB, and the Python that it needs
    python tests/consumers/path_tracer.py PROGRAM [--picture FILE.png]     about 8 minutes

White GGX spheres of four roughnesses and two anisotropies under two panoramas of `bake --target blender`: the
certified sums agree with Cycles within its noise and a bound, the pyramid within its own, and the split sum,
N = V = R as engines have it, is printed beside them. A furnace confirms the masking term first. Another
alpha, another tangent and a mirrored panorama must fail. Exit status 0 when all agree, 1 otherwise."""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np

from blender import picture, quietly, scene_with
from recipes import ROOT, SUNNY, Checks, query, relative, run, sphere

FURNACE = ROOT / "hdr" / "furnace.exr"
PANORAMAS = {"sky": SUNNY, "studio": ROOT / "hdr" / "studio.hdr"}
ROUGHNESSES, ANISOTROPIES = (0.2, 0.35, 0.5, 0.8), (0, 0.5)
EYE = np.array((0.7588, 0.5311, -0.3794)) / np.linalg.norm((0.7588, 0.5311, -0.3794))
# Edge of a sphere's picture in pixels, rays a pixel of one of two renders, and the largest squared distance
# from the centre that is drawn. Spheres are compared where n.v is at least FACING: beyond, Cycles bends
# normals of meshes so that no reflection points into them.
SIZE, RAYS, DRAWN, FACING = 96, 512, 0.99, 0.2
# Directional albedo: what the noise leaves of a mean over a ring.
FURNACE_RAYS, ALBEDO = 128, 0.002
# What may be left of the relative RMS difference without the noise of Cycles; thin lobes, of a roughness and
# an anisotropy, are beyond the pyramid's reads.
EXACT, PYRAMID, THIN = 0.006, {0: 0.02, 0.5: 0.06}, {(0.2, 0.5): 0.2}
# What an error of the material or the panorama must exceed.
WRONG = 0.05
# The split sum is wrong by more; no claim, but it shows that the comparison tells the two apart.
SPLIT_SUM = 0.02
PICTURED = "sky"
LUMINANCE = (0.2126, 0.7152, 0.0722)


def alphas(roughness, anisotropy):
    """Along and across the tangent, as in KHR_materials_anisotropy."""
    across = roughness**2
    return across + (1 - across) * anisotropy**2, across


def surface(along, across, rotation=0):
    """Cycles' node with these alphas.

    It has alpha = roughness^2, and for an anisotropy a below 0 alpha / (1 + a) along the tangent and
    alpha (1 + a) across it. The tangent is the axis times the normal."""
    made = bpy.data.materials.new("ggx")
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    nodes.clear()
    shader, tangent = nodes.new("ShaderNodeBsdfAnisotropic"), nodes.new("ShaderNodeTangent")
    # Single scattering: MULTI_GGX adds what a white surface loses.
    shader.distribution = "GGX"
    shader.inputs["Color"].default_value = (1, 1, 1, 1)
    shader.inputs["Roughness"].default_value = (along * across) ** 0.25
    shader.inputs["Anisotropy"].default_value = (across / along) ** 0.5 - 1
    shader.inputs["Rotation"].default_value = rotation
    tangent.direction_type, tangent.axis = "RADIAL", "Z"
    links.new(tangent.outputs[0], shader.inputs["Tangent"])
    links.new(shader.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return made


def stage(panorama):
    """The recipe's scene with a sphere fine enough for grazing views, and rays through pixels' centres."""
    scene, ball = scene_with(panorama)
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BLACKMAN_HARRIS", 0.01
    bpy.data.objects.remove(ball)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=1, segments=512, ring_count=256)
    bpy.ops.object.shade_smooth()
    return scene, bpy.context.object


class Views:
    """Pixels of the sphere, and what the program answers for them."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.rows, self.columns, self.normals, _ = sphere(SIZE, EYE, 1, DRAWN)
        self.view = EYE
        self.facing = self.normals @ self.view
        # In glTF's axes, where Blender's Z is Y.
        self.tangents = np.cross((0, 1, 0), self.normals)
        self.tangents /= np.linalg.norm(self.tangents, axis=1, keepdims=True)
        self.compared = self.facing >= FACING
        self.albedos = {}

    def reflected(self, source, lobe, roughness, anisotropy):
        """The reflection by the filter `lobe`."""
        frames, out = self.folder / "frames.npy", self.folder / "answers.npy"
        views = np.broadcast_to(self.view, self.normals.shape)
        np.save(frames, np.hstack([self.normals, views, self.tangents]))
        options = ["--roughness", roughness, "--anisotropy", anisotropy, "--f0", 1, "--filter", lobe]
        command = [
            self.program,
            "query",
            source,
            "--frames",
            frames,
            "-o",
            out,
            "--force",
            "--quiet",
            *options,
        ]
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(done.stderr)
        return np.load(out)[:, :3].astype(float)

    def albedo(self, roughness, anisotropy):
        if (roughness, anisotropy) not in self.albedos:
            answers = self.reflected(FURNACE, "reference", roughness, anisotropy)
            self.albedos[roughness, anisotropy] = answers[:, :1]
        return self.albedos[roughness, anisotropy]

    def split_sum(self, source, roughness, anisotropy):
        """The lobe around the mirrored view for N = V = R, times the albedo of this view.

        As engines do for anisotropy: the lobe stays isotropic, and the normal bends towards the viewer,
        across the bitangent."""
        normals = self.normals
        if anisotropy:
            bitangents = np.cross(normals, self.tangents)
            bent = np.cross(np.cross(bitangents, self.view), bitangents)
            bent /= np.linalg.norm(bent, axis=1, keepdims=True)
            share = (1 - anisotropy * (1 - roughness)) ** 4
            normals = bent + (normals - bent) * share
            normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        mirrored = 2 * (normals @ self.view)[:, None] * normals - self.view
        lobe = query(self.program, mirrored, "--roughness", str(roughness), source=source)
        return lobe * self.albedo(roughness, 0)


def separable(roughness, facing, steps=256):
    """Directional albedo with the masking G1(l) G1(v), which is not ours: a sum over half vectors."""
    alpha = roughness**2
    turns = 2 * np.pi * (np.arange(steps) + 0.5) / steps
    shares = (np.arange(steps) + 0.5) / steps
    slopes, turns = np.meshgrid(alpha * np.sqrt(shares / (1 - shares)), turns)
    cosine = 1 / np.sqrt(1 + slopes**2)
    towards = cosine * (slopes * np.cos(turns) * np.sqrt(1 - facing**2) + facing)
    light = 2 * towards * cosine - facing
    seen = (towards > 0) & (light > 0)

    def masking(z):
        return 2 / (1 + np.sqrt(1 + alpha**2 * (1 / np.maximum(z, 1e-9) ** 2 - 1)))

    return np.where(seen, masking(facing) * masking(light) * towards / (facing * cosine), 0).mean()


class Cycles:
    def __init__(self, views, panorama):
        self.views, self.folder = views, views.folder
        self.scene, self.ball = quietly(lambda: stage(panorama))

    def sphere(self, made, rays=RAYS, seed=1):
        self.scene.cycles.seed = seed
        view = (SIZE, rays, DRAWN)
        shown = quietly(lambda: picture(self.scene, self.ball, EYE, made, self.folder, view))
        return shown[self.views.rows, self.views.columns]

    def pair(self, made):
        """The mean of two renders, and the relative RMS of its noise."""
        first, second = (self.sphere(made, seed=seed) for seed in (1, 2))
        compared = self.views.compared
        return (first + second) / 2, relative(first[compared], second[compared]) / 2


def furnace(views, panorama, checks):
    """Directional albedo over rings of equal n.v.

    Found: Cycles 4.5 has the height-correlated Smith term, D G2 / (4 n.v) with
    G2 = 1 / (1 + lambda(v) + lambda(l)), and adds nothing for multiple scattering: it differs by 0.0011 at
    most, which is noise, where separable masking is off by 0.067."""
    cycles = Cycles(views, panorama)
    facing = views.facing
    rings = [np.abs(facing - middle) < 0.02 for middle in (0.22, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.97)]
    other = 0
    for roughness in ROUGHNESSES:
        for anisotropy in ANISOTROPIES:
            made = surface(*alphas(roughness, anisotropy))
            shown = cycles.sphere(made, rays=FURNACE_RAYS).mean(1)
            exact = views.albedo(roughness, anisotropy)
            worst = max(abs(shown[ring].mean() - exact[ring].mean()) for ring in rings)
            checks.below(
                f"Cycles {bpy.app.version_string}, furnace, r {roughness}, anisotropy {anisotropy}",
                worst,
                ALBEDO,
            )
            if anisotropy == 0:
                gap = [abs(separable(roughness, facing[ring].mean()) - shown[ring].mean()) for ring in rings]
                other = max(other, *gap)
    checks.above("Cycles, masking that is not height-correlated is seen", other, 10 * ALBEDO)


def excess(error, noise):
    """What is left of a relative RMS difference without independent noise."""
    return max(error**2 - noise**2, 0) ** 0.5


class Cell:
    """A sphere by Cycles, by the program and by the split sum."""

    def __init__(self, views, source, roughness, anisotropy, shown, noise):
        self.source, self.roughness, self.anisotropy = source, roughness, anisotropy
        self.shown, self.noise = shown, noise
        self.answers = {
            "sums": views.reflected(source, "adaptive:0.002", roughness, anisotropy),
            "pyramid": views.reflected(source, "pyramid", roughness, anisotropy),
            "split sum": views.split_sum(source, roughness, anisotropy),
        }
        compared = views.compared
        self.errors = {
            kind: relative(answer[compared], shown[compared]) for kind, answer in self.answers.items()
        }


def judge(cell, name, checks):
    what = f"Cycles, {name}, r {cell.roughness}, anisotropy {cell.anisotropy}"
    left = {kind: excess(error, cell.noise) for kind, error in cell.errors.items()}
    checks.below(f"{what}, sums, beyond noise of {cell.noise:.4f}", left["sums"], EXACT)
    bound = THIN.get((cell.roughness, cell.anisotropy), PYRAMID[cell.anisotropy])
    checks.below(f"{what}, pyramid", left["pyramid"], bound)
    checks.above(f"{what}, split sum", left["split sum"], SPLIT_SUM)


def must_fail(cycles, cell, checks, made, what):
    compared = cycles.views.compared
    error = relative(cycles.sphere(made)[compared], cell.answers["sums"][compared])
    checks.above(f"Cycles, {what} is seen", error, WRONG)


def main(program, drawn):
    program = str(Path(program).resolve())
    checks, cells = Checks(), {}
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        views = Views(program, folder)

        def bake(source, name, *options):
            command = ["bake", source, "--target", "blender", "--name", "sky", "--quiet", *options]
            run(program, *command, "-o", folder / name)
            return folder / name / "sky_panorama.exr"

        furnace(views, bake(FURNACE, "furnace"), checks)
        for name, source in PANORAMAS.items():
            cycles = Cycles(views, bake(source, name))
            for anisotropy in ANISOTROPIES:
                for roughness in ROUGHNESSES:
                    shown, noise = cycles.pair(surface(*alphas(roughness, anisotropy)))
                    cell = Cell(views, source, roughness, anisotropy, shown, noise)
                    cells[name, roughness, anisotropy] = cell
                    judge(cell, name, checks)
            round_one, long_one = cells[name, 0.35, 0], cells[name, 0.35, 0.5]
            along, across = alphas(0.35, 0)
            must_fail(cycles, round_one, checks, surface(1.1 * along, 1.1 * across), f"{name}, alpha of 1.1")
            along, across = alphas(0.35, 0.5)
            must_fail(
                cycles, long_one, checks, surface(1.2 * along, across), f"{name}, 1.2 along the tangent"
            )
            turned = surface(along, across, rotation=0.25)
            must_fail(cycles, long_one, checks, turned, f"{name}, a tangent that is turned")
            cycles = Cycles(views, bake(source, f"{name}-mirrored", "--mirror"))
            made = surface(*alphas(0.35, 0))
            must_fail(cycles, round_one, checks, made, f"{name}, a panorama that is mirrored")
    print("\nrelative RMS difference  noise    sums     pyramid  split sum")
    for (name, roughness, anisotropy), cell in cells.items():
        shown = [cell.noise, *(cell.errors[kind] for kind in ("sums", "pyramid", "split sum"))]
        figures = "  ".join(f"{value:7.4f}" for value in shown)
        print(f"{name:7} r {roughness:<4} anisotropy {anisotropy:<3}  {figures}")
    if drawn:
        draw(cells, views, drawn)
    return 1 if checks.failures else 0


# The picture: exposure, edge of a cell, width of the labels, and the errors at the ends of the scale.
EXPOSURE, EDGE, LABELS, LEAST, MOST = 1.0, 114, 128, 1e-3, 1
PAPER, INK = (255, 255, 255), (30, 30, 34)
# Evenly spaced colours of the scale of errors.
SCALE = np.array([(8, 8, 32), (52, 26, 106), (124, 40, 124), (200, 62, 100), (246, 124, 70), (252, 250, 200)])


def tone_mapped(radiance):
    linear = 1 - np.exp(-EXPOSURE * radiance)
    return 255 * np.where(
        linear < 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055
    )


def false_colour(errors):
    """Between LEAST and MOST, by their logarithm."""
    place = np.log(np.clip(errors, LEAST, MOST) / LEAST) / np.log(MOST / LEAST) * (len(SCALE) - 1)
    return np.stack([np.interp(place, range(len(SCALE)), channel) for channel in SCALE.T], -1)


def disc(views, colours):
    """A cell with the sphere's pixels in `colours`; the rim covers pixels in part."""
    cell = np.tile(np.array(PAPER, float), (EDGE, EDGE, 1))
    margin = (EDGE - SIZE) // 2
    distance = np.hypot(views.rows + 0.5 - SIZE / 2, views.columns + 0.5 - SIZE / 2)
    cover = np.clip(DRAWN**0.5 * SIZE / 2 - 0.5 - distance, 0, 1)[:, None]
    places = views.rows + margin, views.columns + margin
    cell[places] += cover * (colours - cell[places])
    return cell


def draw(cells, views, file):
    from PIL import Image, ImageDraw, ImageFont

    columns = [(roughness, anisotropy) for anisotropy in ANISOTROPIES for roughness in ROUGHNESSES]
    rows = [
        ("Cycles", None, False),
        ("octagloss,\nexact sums", "sums", False),
        ("octagloss,\npyramid", "pyramid", False),
        ("split sum,\nN = V = R", "split sum", False),
        ("error of\nexact sums", "sums", True),
        ("error of\npyramid", "pyramid", True),
        ("error of\nsplit sum", "split sum", True),
    ]
    top, step, foot = 56, EDGE + 2, 16
    heights = [step + (foot if is_error else 0) for _, _, is_error in rows]
    sheet = Image.new("RGB", (LABELS + len(columns) * EDGE + 12, top + sum(heights) + 44), PAPER)
    pen = ImageDraw.Draw(sheet)
    large, small = ImageFont.load_default(16), ImageFont.load_default(13)
    for at, (roughness, _) in enumerate(columns):
        x = LABELS + at * EDGE + EDGE // 2
        pen.text((x, 42), f"roughness {roughness}", INK, small, anchor="mm")
    for at, anisotropy in enumerate(ANISOTROPIES):
        x = LABELS + (at + 0.5) * len(ROUGHNESSES) * EDGE
        pen.text((x, 18), f"anisotropy {anisotropy}" if anisotropy else "isotropic", INK, large, anchor="mm")
    y = top
    for (label, kind, is_error), height in zip(rows, heights, strict=True):
        pen.text((12, y + EDGE // 2), label, INK, large, anchor="lm")
        for at, (roughness, anisotropy) in enumerate(columns):
            cell = cells[PICTURED, roughness, anisotropy]
            x = LABELS + at * EDGE
            answer = cell.answers[kind] if kind else cell.shown
            if is_error:
                difference = np.abs(answer - cell.shown) @ LUMINANCE / (cell.shown @ LUMINANCE)
                colours = false_colour(difference)
                figure = f"{100 * cell.errors[kind]:.1f} %"
                pen.text((x + EDGE // 2, y + EDGE + 5), figure, INK, small, anchor="mm")
            else:
                colours = tone_mapped(answer)
            pixels = np.clip(disc(views, colours).round(), 0, 255).astype(np.uint8)
            sheet.paste(Image.fromarray(pixels), (x, y))
        y += height
    bar = np.geomspace(LEAST, MOST, 480)
    pixels = np.tile(false_colour(bar).round().astype(np.uint8), (12, 1, 1))
    sheet.paste(Image.fromarray(pixels), (LABELS + 10, y + 6))
    for value in (0.001, 0.01, 0.1, 1):
        x = LABELS + 10 + 480 * np.log(value / LEAST) / np.log(MOST / LEAST)
        pen.text((x, y + 29), f"{100 * value:g} %", INK, small, anchor="mm")
    pen.text(
        (LABELS + 510, y + 12),
        "relative difference from Cycles; figures: RMS over a sphere",
        INK,
        small,
        anchor="lm",
    )
    # Noise hardly compresses: 256 colours take a third.
    colours = sheet.quantize(256, Image.Quantize.MAXCOVERAGE)
    sheet.quantize(palette=colours, dither=Image.Dither.FLOYDSTEINBERG).save(file, optimize=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program")
    parser.add_argument("--picture", type=Path, metavar="FILE.png")
    arguments = parser.parse_args()
    sys.exit(main(arguments.program, arguments.picture))
