"""Recipes of docs/engines.md, and pictures of a sphere to compare with the program's answers."""

import re
import subprocess
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
LABELLED = ROOT / "hdr" / "labelled.exr"
SUNNY = ROOT / "hdr" / "sky.exr"
# Views: the six sides of glTF's world, and a corner.
EYES = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1), (0.7588, 0.5311, -0.3794)]


def recipe(engine, language):
    """The code in `language` under the heading `engine`."""
    text = (ROOT / "docs" / "engines.md").read_text()
    section = re.search(rf"^## {re.escape(engine)}\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    code = section and re.search(rf"^```{language}\n(.*?)^```$", section[1], re.M | re.S)
    if not code:
        raise SystemExit(f"docs/engines.md: no {language} under {engine}")
    return code[1]


def run(program, *arguments, text=None):
    done = subprocess.run([program, *map(str, arguments)], input=text, capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, arguments))}: {done.stderr}")
    return done.stdout


def query(program, directions, *options, source=LABELLED):
    """Answers of the program for `directions` in glTF's axes."""
    text = "x,y,z\n" + "\n".join(",".join(repr(float(v)) for v in d) for d in directions) + "\n"
    rows = run(program, "query", source, "--directions", "-", "--quiet", *options, text=text)
    return np.array([[float(v) for v in row.split(",")[3:]] for row in rows.strip().split("\n")[1:]])


def axes(eye):
    """Right and up of a viewer at `eye` who looks at the origin."""
    eye = np.array(eye, float)
    right = np.cross((0, 0, 1) if abs(eye[1]) > 0.9 else (0, 1, 0), eye)
    right /= np.linalg.norm(right)
    return right, np.cross(eye, right)


def sphere(size, eye, step, most=0.8):
    """Pixels of an orthographic view of the unit sphere, rows downwards: rows, columns, normals and mirrored
    views. `most` is the largest squared distance from the centre."""
    eye = np.array(eye, float)
    right, up = axes(eye)
    places = np.arange(step // 2, size, step)
    rows, columns = (grid.ravel() for grid in np.meshgrid(places, places, indexing="ij"))
    x, y = (2 * columns + 1) / size - 1, 1 - (2 * rows + 1) / size
    inside = x * x + y * y <= most
    rows, columns, x, y = rows[inside], columns[inside], x[inside], y[inside]
    z = np.sqrt(1 - x * x - y * y)
    normals = x[:, None] * right + y[:, None] * up + z[:, None] * eye
    return rows, columns, normals, 2 * z[:, None] * normals - eye


def relative(shown, exact):
    """Relative RMS difference, against luminance as in pictures.mjs."""
    if shown.shape != exact.shape or len(shown) < 12:
        raise SystemExit(f"{shown.shape} pixels to compare with {exact.shape}")
    luminance = exact @ (0.2126, 0.7152, 0.0722)
    return float(np.sqrt(((shown - exact) ** 2).mean() / (luminance**2).mean()))


def worst_channel(shown, exact):
    """Greatest difference of a channel over the channel's greatest exact value."""
    if shown.shape != exact.shape or len(shown) < 12:
        raise SystemExit(f"{shown.shape} pixels to compare with {exact.shape}")
    return float((np.abs(shown - exact).max(0) / exact.max(0)).max())


class Checks:
    failures = 0

    def check(self, holds, what):
        print(("ok     " if holds else "FAILED ") + what, flush=True)
        self.failures += not holds

    def below(self, what, error, most):
        self.check(error < most, f"{what}: relative error {error:.4f}, at most {most}")

    def above(self, what, error, least):
        self.check(error > least, f"{what}: relative error {error:.4f}, at least {least}")
