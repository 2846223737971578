"""Shared fixtures: the command line that results are compared with, and small environments."""

import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import octagloss

REPOSITORY = Path(__file__).resolve().parents[2]
PROGRAM = Path(os.environ.get("OCTAGLOSS", REPOSITORY / "target/release/octagloss"))


class CommandLine:
    """Runs octagloss in a folder."""

    def __init__(self, folder):
        self.folder = folder

    def __call__(self, *args, code=0):
        command = [str(PROGRAM), *map(str, args)]
        ran = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, check=False)
        assert ran.returncode == code, f"{command}: {ran.stderr}"
        return ran.stdout

    def query(self, environment, directions, *args):
        """The columns r, g, b (and bound) for directions of shape (n, 3) or (n, 4), as float32."""
        np.save(self.folder / "directions.npy", directions)
        columns = ["--directions", "directions.npy", "-o", "answers.npy"]
        self("query", environment, *columns, "--engine", "cpu", "--quiet", "--force", *args)
        return np.load(self.folder / "answers.npy")

    def json(self, *args):
        return json.loads(self(*args))


@pytest.fixture
def program(tmp_path):
    assert PROGRAM.is_file(), f"{PROGRAM} is missing: cargo build --release, or set OCTAGLOSS to the program"
    return CommandLine(tmp_path)


@pytest.fixture(scope="session")
def sky_file():
    return REPOSITORY / "hdr/sky.exr"


@pytest.fixture(scope="session")
def sky(sky_file):
    return octagloss.Environment.from_file(sky_file)


@pytest.fixture(scope="session")
def lamp():
    """A dim panorama with one lamp where it looks along +X."""
    texels = np.full((32, 64, 3), 0.1, np.float32)
    texels[16, 32] = (100.0, 80.0, 60.0)
    return octagloss.Environment.from_array(texels)


@pytest.fixture(scope="session")
def directions():
    """A spiral of 200 directions of several lengths."""
    k = np.arange(200)
    y = 1.0 - (2.0 * k + 1.0) / 200.0
    radius, angle = np.sqrt(1.0 - y * y), k * np.pi * (3.0 - np.sqrt(5.0))
    spiral = np.stack([radius * np.cos(angle), y, radius * np.sin(angle)], axis=-1)
    return spiral * (0.5 + k[:, None] % 3)
