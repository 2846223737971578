#!/usr/bin/env python3
"""Draws cmgen's prefiltered levels above ours, for the picture in the README.

    apt-get install libfilament-tools
    cmgen.py target/release/octagloss hdr/sky.exr -o hdr/cmgen.png

Both bake five levels of Filament's ladder at 256 x 256. Each sphere is a mirror that looks up one level,
bilinearly within a face. cmgen puts the panorama's centre at +Z; our bake is turned to match. """

import argparse
import pathlib
import subprocess
import tempfile

import numpy as np
import OpenEXR
import OpenImageIO as oiio

FACES = ("px", "nx", "py", "ny", "pz", "nz")
SIDE = 220  # pixels of a sphere
LEVELS = (1, 2, 3, 4)


def read_level(folder, level):
    """Six faces of a level, (6, n, n, 3)."""

    def face(name):
        channels = OpenEXR.File(str(folder / f"m{level}_{name}.exr")).channels()
        if "RGB" in channels or "RGBA" in channels:
            return channels.get("RGB", channels.get("RGBA")).pixels[..., :3]
        return np.stack([channels[c].pixels for c in "RGB"], -1)

    return np.stack([np.asarray(face(name), np.float64) for name in FACES])


def look_up(faces, d):
    """Radiance along the directions d (m, 3), bilinear within a face."""
    n = faces.shape[1]
    x, y, z = d.T
    axis = np.abs(d).argmax(1)
    positive = np.take_along_axis(d, axis[:, None], 1)[:, 0] > 0
    face = 2 * axis + ~positive
    s = np.choose(face, [-z, z, x, x, x, -x])
    t = np.choose(face, [-y, -y, z, -z, -y, -y])
    longest = np.abs(d).max(1)
    column = np.clip((s / longest + 1) / 2 * n - 0.5, 0, n - 1)
    row = np.clip((t / longest + 1) / 2 * n - 0.5, 0, n - 1)
    i, j = np.minimum(column.astype(int), n - 2), np.minimum(row.astype(int), n - 2)
    a, b = (column - i)[:, None], (row - j)[:, None]
    top = faces[face, j, i] * (1 - a) + faces[face, j, i + 1] * a
    bottom = faces[face, j + 1, i] * (1 - a) + faces[face, j + 1, i + 1] * a
    return top * (1 - b) + bottom * b


def sphere(faces, towards, exposure):
    """A mirror sphere that reflects the surroundings of `towards`."""
    front = towards / np.linalg.norm(towards)
    right = np.cross(front, [0, 1, 0])
    right /= np.linalg.norm(right)
    up = np.cross(right, front)
    at = (np.arange(SIDE) + 0.5) / SIDE * 2.2 - 1.1
    u, v = np.meshgrid(at, -at)
    inside = u * u + v * v < 1
    w = np.sqrt(np.clip(1 - u * u - v * v, 0, 1))
    normal = u[..., None] * right + v[..., None] * up + w[..., None] * front
    view = -front
    mirrored = view - 2 * (normal @ view)[..., None] * normal
    image = np.full((SIDE, SIDE, 3), 0.045)
    # Lower exposure and a wide tone curve keep both the sun's highlight and the sky visible.
    radiance = look_up(faces, mirrored[inside]) * exposure
    image[inside] = radiance / (1 + radiance)
    return np.round(image ** (1 / 2.2) * 255).astype(np.uint8)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("program"), parser.add_argument("environment")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--towards", type=float, nargs=3, default=[-0.7, 0.25, 0.65])
    parser.add_argument("--exposure", type=float, default=-1.5, help="in EV")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        theirs, ours = pathlib.Path(scratch) / "cmgen", pathlib.Path(scratch) / "octagloss"
        subprocess.run(
            [
                "cmgen",
                "--quiet",
                "--type=cubemap",
                "--format=exr",
                "--size=256",
                f"--ibl-ld={theirs}",
                args.environment,
            ],
            check=True,
        )
        subprocess.run(
            [
                args.program,
                "bake",
                args.environment,
                "--rotate-y",
                "-90",
                "--ladder",
                "filament",
                "--levels",
                "5",
            ]
            + ["--format", "exr", "--pixel", "f32", "--quiet", "-o", str(ours)],
            check=True,
        )
        theirs /= pathlib.Path(args.environment).stem
        exposure, towards = 2.0**args.exposure, np.array(args.towards)
        rows = [
            np.hstack([sphere(read_level(folder, level), towards, exposure) for level in LEVELS])
            for folder in (theirs, ours)
        ]
    picture = np.vstack(rows)
    height, width, _ = picture.shape
    output = oiio.ImageOutput.create(args.output)
    output.open(args.output, oiio.ImageSpec(width, height, 3, "uint8"))
    output.write_image(picture)
    output.close()


if __name__ == "__main__":
    main()
