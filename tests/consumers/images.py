"""Reads every EXR that a bake writes with OpenEXR and OpenImageIO, and a BC6H DDS with OpenImageIO.

    python tests/consumers/images.py PROGRAM

Both must read the same numbers, and those that `octagloss query` gives. Exit status 0 when all agree, 1
otherwise. """

import sys
import tempfile
from pathlib import Path

import numpy as np
import OpenEXR
import OpenImageIO as oiio
from recipes import ROOT, run

FACES = {
    "px": lambda s, t: (1 + 0 * s, -t, -s),
    "nx": lambda s, t: (-1 + 0 * s, -t, s),
    "py": lambda s, t: (s, 1 + 0 * s, t),
    "ny": lambda s, t: (s, -1 + 0 * s, -t),
    "pz": lambda s, t: (s, -t, 1 + 0 * s),
    "nz": lambda s, t: (-s, -t, -1 + 0 * s),
}


def by_openexr(path):
    """Channels by name, and the header."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {name: np.array(channel.pixels) for name, channel in file.channels().items()}
        return channels, dict(file.header())


def by_oiio(path):
    buffer = oiio.ImageBuf(str(path))
    if buffer.has_error:
        raise SystemExit(f"{path}: OpenImageIO: {buffer.geterror()}")
    pixels = buffer.get_pixels(oiio.FLOAT)
    return {name: pixels[:, :, at] for at, name in enumerate(buffer.spec().channelnames)}


def query(program, environment, directions, roughness):
    text = "x,y,z\n" + "\n".join(",".join(repr(float(v)) for v in d) for d in directions) + "\n"
    rows = run(
        program,
        "query",
        environment,
        "--directions",
        "-",
        "--roughness",
        str(roughness),
        "--oem-size",
        "512",
        "--quiet",
        text=text,
    )
    return np.array([[float(v) for v in row.split(",")[3:]] for row in rows.strip().split("\n")[1:]])


def relative(shown, exact):
    """Relative RMS difference."""
    return float(np.sqrt(((shown - exact) ** 2).mean() / (exact**2).mean()))


def check(holds, what):
    print(("ok     " if holds else "FAILED ") + what)
    return 0 if holds else 1


def main(program):
    failures = 0
    environment = str(ROOT / "hdr" / "sky.exr")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for pixel, dtype in (("f16", np.float16), ("f32", np.float32), (None, None)):
            out = folder / f"bake-{pixel}"
            options = ["--pixel", pixel] if pixel else []
            run(
                program,
                "bake",
                environment,
                "--size",
                "64",
                "--levels",
                "5",
                "--format",
                "exr",
                "--bounds",
                "--irradiance",
                "8",
                *options,
                "-o",
                str(out),
                "--quiet",
            )
            files = sorted(out.glob("*.exr"))
            # Five levels of six faces, those of irradiance, and bounds of the four levels that have them.
            failures += check(len(files) == 30 + 6 + 24, f"{pixel or 'auto'}: {len(files)} files")
            for path in files:
                channels, header = by_openexr(path)
                other = by_oiio(path)
                names = ["Y"] if path.stem.endswith("bound") else ["B", "G", "R"]
                same = sorted(channels) == names == sorted(other)
                same = same and all(np.array_equal(channels[n].astype(np.float32), other[n]) for n in names)
                same = same and all(np.isfinite(channels[n]).all() and channels[n].size > 0 for n in names)
                if dtype and names != ["Y"]:
                    same = same and all(channels[n].dtype == dtype for n in names)
                same = same and header["compression"] == OpenEXR.ZIP_COMPRESSION
                if not same:
                    failures += check(False, f"{path.name}: OpenEXR and OpenImageIO agree")
            print(f"ok     {pixel or 'auto'}: read by OpenEXR and OpenImageIO alike" if failures == 0 else "")
        # Compare their result with the program's query: roughness 0.5 is level 2 of five, 16 texels a side.
        centres = (np.arange(16) + 0.5) / 8 - 1
        s, t = np.meshgrid(centres, centres)
        shown, exact = [], []
        for name, direction in FACES.items():
            channels, _ = by_openexr(folder / "bake-f32" / f"m2_{name}.exr")
            shown.append(np.stack([channels[c] for c in "RGB"], -1))
            directions = np.stack(direction(s, t), -1).reshape(-1, 3)
            exact.append(query(program, environment, directions, 0.5).reshape(16, 16, 3))
        shown, exact = np.array(shown), np.array(exact)
        error, mirrored = relative(shown, exact), relative(shown[:, :, ::-1], exact)
        failures += check(error < 0.01, f"level 2 as OpenEXR reads it is what query answers: {error:.4f}")
        failures += check(mirrored > 0.2, f"mirrored faces are seen: {mirrored:.4f}")

        # A BC6H cube: OpenImageIO stacks its faces. Level 0 only: the reader expects the others elsewhere.
        labelled = str(ROOT / "hdr" / "labelled.exr")
        for options, place in ((["--pixel", "bc6h"], "a.dds"), (["--format", "exr"], "a")):
            run(
                program,
                "bake",
                labelled,
                "--size",
                "64",
                "--levels",
                "1",
                *options,
                "-o",
                str(folder / place),
                "--quiet",
            )
        buffer = oiio.ImageBuf(str(folder / "a.dds"))
        shown = buffer.get_pixels(oiio.FLOAT)[:, :, :3]
        failures += check(
            not buffer.has_error and shown.shape == (384, 64, 3), f"DDS by OpenImageIO: {shown.shape}"
        )
        exact = [by_oiio(folder / "a" / f"m0_{name}.exr") for name in FACES]
        exact = np.concatenate([np.stack([face[c] for c in "RGB"], -1) for face in exact])
        error = relative(shown, exact)
        failures += check(error < 0.03, f"its BC6H beside half floats: {error:.4f}")
        failures += check(relative(shown[:, ::-1], exact) > 0.2, "mirrored faces are seen")
    return 1 if failures else 0


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    sys.exit(main(sys.argv[1]))
