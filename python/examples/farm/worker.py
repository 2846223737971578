"""The work of one task: bakes panoramas one after the other, and writes a record next to each bake.

A record (`farm.json`) is written last and has the hashes of the request and of every output. A bake is kept
if its record matches the request and the content of all its outputs.
"""

import hashlib
import io
import json
import os
import socket
import tempfile
import time
import warnings
from dataclasses import asdict, dataclass, field
from functools import lru_cache
from pathlib import Path, PurePosixPath
from typing import Any, Dict, List, Optional, Tuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

import octagloss
from storage import Storage

RECORD = "farm.json"
PICTURE = "farm.png"
PICTURE_WIDTH = 128


@dataclass(frozen=True)
class Job:
    """What all tasks of a run share."""

    run: str
    source: str
    output: str
    # Keyword arguments of octagloss.bake.
    options: Dict[str, Any]
    threads: int


@dataclass
class Outcome:
    """What became of one panorama; a line of the summary."""

    input: str
    # baked, unchanged, failed, or retry: failed by a cause that may pass.
    status: str
    seconds: float = 0.0
    attempts: int = 1
    width: int = 0
    height: int = 0
    input_bytes: int = 0
    output_bytes: int = 0
    outputs: Dict[str, Dict[str, Any]] = field(default_factory=dict)
    exposure: float = 0.0
    roughness: float = 0.0
    worker: str = ""
    warnings: List[str] = field(default_factory=list)
    error: Optional[str] = None
    picture: bytes = b""

    def line(self) -> str:
        """JSON without the picture."""
        shown = asdict(self)
        del shown["picture"]
        return json.dumps(shown)


def stem(name: str) -> str:
    """The folder of a panorama's bake: its name without the extension."""
    return str(PurePosixPath(name).with_suffix(""))


def sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def work(job: Job, names: List[str]) -> List[Outcome]:
    """Bakes the panoramas that have no whole bake of this request yet."""
    octagloss.set_threads(job.threads)
    source, output = Storage(job.source), Storage(job.output)
    return [attempt(job, source, output, name) for name in names]


def attempt(job: Job, source: Storage, output: Storage, name: str) -> Outcome:
    """Bakes one panorama; errors become its outcome."""
    start = time.perf_counter()
    try:
        outcome = bake(job, source, output, name)
    except (ValueError, TypeError, MemoryError) as error:
        # Of the panorama or the options: another attempt would end the same.
        outcome = Outcome(name, "failed", error=f"{type(error).__name__}: {error}")
    except Exception as error:
        outcome = Outcome(name, "retry", error=f"{type(error).__name__}: {error}")
    outcome.seconds = round(time.perf_counter() - start, 4)
    outcome.worker = outcome.worker or worker_name()
    return outcome


def worker_name() -> str:
    return f"{socket.gethostname()}:{os.getpid()}"


def bake(job: Job, source: Storage, output: Storage, name: str) -> Outcome:
    content = source.read(name)
    asked = json.dumps([octagloss.__version__, job.options, sha256(content)], sort_keys=True)
    request = sha256(asked.encode())
    folder = stem(name)
    record, outputs = whole_bake(output, folder, request)
    if record is None:
        record = bake_anew(job, source, output, name, content, request, outputs)
    picture = output.read(f"{folder}/{PICTURE}")
    status = "baked" if record["run"] == job.run else "unchanged"
    return Outcome(name, status, picture=picture, **record["outcome"])


def whole_bake(output: Storage, folder: str, request: str) -> Tuple[Optional[Dict[str, Any]], List[str]]:
    """The record of a whole bake of this request, or None; the names of the outputs of any bake there."""
    text = output.read_if_there(f"{folder}/{RECORD}")
    try:
        record = json.loads(text or b"null")
        outputs: Dict[str, Dict[str, Any]] = record["outcome"]["outputs"]
        is_same = record["request"] == request and record["run"] is not None
    except (ValueError, TypeError, KeyError):
        return None, []
    if is_same:
        for name, hashed in outputs.items():
            content = output.read_if_there(f"{folder}/{name}")
            if content is None or len(content) != hashed["bytes"] or sha256(content) != hashed["sha256"]:
                is_same = False
                break
    return (record if is_same else None), list(outputs)


def bake_anew(
    job: Job, source: Storage, output: Storage, name: str, content: bytes, request: str, earlier: List[str]
) -> Dict[str, Any]:
    """Bakes into a temporary folder, copies the files, then writes the record."""
    folder = stem(name)
    with (
        tempfile.TemporaryDirectory(prefix="farm-") as temporary,
        warnings.catch_warnings(record=True) as warned,
    ):
        warnings.simplefilter("always")
        if source.is_local:
            path = source.path(name)
        else:
            path = str(Path(temporary) / PurePosixPath(name).name)
            Path(path).write_bytes(content)
        environment = octagloss.Environment.from_file(path)
        made = Path(temporary) / "bake"
        if job.options.get("target") is None:
            made.mkdir()
            single = made / f"{PurePosixPath(name).stem}.ktx2"
            baked = octagloss.bake(environment, output=single, **job.options)
        else:
            baked = octagloss.bake(environment, output=made, **job.options)
        picture, exposure, roughness = picture_of(environment, baked)
        files = {str(file.relative_to(made)): file.read_bytes() for file in made.rglob("*") if file.is_file()}
    files = {place.replace(os.sep, "/"): file for place, file in sorted(files.items())}
    files[PICTURE] = picture
    for place, file in files.items():
        output.write(f"{folder}/{place}", file)
    for place in set(earlier) - set(files):
        output.remove(f"{folder}/{place}")
    hashes = {place: {"bytes": len(file), "sha256": sha256(file)} for place, file in files.items()}
    height, width = environment.texels.shape[-3:-1]
    record = {
        "run": job.run,
        "request": request,
        "outcome": {
            "width": width,
            "height": height,
            "input_bytes": len(content),
            "output_bytes": sum(map(len, files.values())),
            "outputs": hashes,
            "exposure": round(exposure, 2),
            "roughness": round(roughness, 4),
            "worker": worker_name(),
            "warnings": list(dict.fromkeys(str(warning.message) for warning in warned)),
        },
    }
    output.write(f"{folder}/{RECORD}", json.dumps(record, indent=1).encode())
    return record


def picture_of(environment: octagloss.Environment, baked: octagloss.Bake) -> Tuple[bytes, float, float]:
    """A PNG of the panorama above the level of roughness nearest 0.5; the exposure in EV, that roughness."""
    level = min(baked.levels, key=lambda level: abs(level.roughness - 0.5))
    shown = [
        nearest(texels, layout, sample_directions())
        .reshape(PICTURE_WIDTH // 2, 2, PICTURE_WIDTH, 2, 3)
        .mean(axis=(1, 3))
        for texels, layout in [(environment.texels, environment.layout), (level.texels, level.layout)]
    ]
    # As the automatic exposure of the command line: middle grey over the logarithmic average.
    luminance = shown[0] @ np.array([0.2126, 0.7152, 0.0722])
    weights = np.cos((np.arange(PICTURE_WIDTH // 2) + 0.5) / (PICTURE_WIDTH // 2) * np.pi - np.pi / 2)
    exposure = 0.0
    if luminance.max() > 0:
        logarithms = np.log2(np.maximum(luminance, luminance.max() * 1e-6)).mean(axis=1)
        exposure = float(np.log2(0.18) - np.average(logarithms, weights=weights))
    linear = np.clip(np.concatenate(shown) * 2.0**exposure, 0, 1)
    srgb = np.where(linear <= 0.0031308, linear * 12.92, 1.055 * linear ** (1 / 2.4) - 0.055)
    file = io.BytesIO()
    Image.fromarray((srgb * 255 + 0.5).astype(np.uint8)).save(file, "PNG")
    return file.getvalue(), exposure, level.roughness


@lru_cache(maxsize=1)
def sample_directions() -> NDArray[np.float64]:
    """Four directions for each pixel of a picture."""
    steps = (np.arange(PICTURE_WIDTH * 2) + 0.5) / (PICTURE_WIDTH * 2)
    u, v = np.meshgrid(steps, (np.arange(PICTURE_WIDTH) + 0.5) / PICTURE_WIDTH)
    return octagloss.maps.direction_from_equirect(np.stack([u, v], axis=-1))


def nearest(texels: NDArray[np.float32], layout: str, directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """The texel that each direction hits."""
    height, width = texels.shape[-3:-1]
    if layout == "cube":
        face, uv = octagloss.maps.cube_from_direction(directions)
    elif layout == "octahedral":
        uv = octagloss.maps.oct_from_direction(directions)
    else:
        uv = octagloss.maps.equirect_from_direction(directions)
    column = np.clip((uv[..., 0] * width).astype(int), 0, width - 1)
    row = np.clip((uv[..., 1] * height).astype(int), 0, height - 1)
    found = texels[face, row, column] if layout == "cube" else texels[row, column]
    return np.asarray(found, np.float64)
