"""Tests of farm.py on local workers: `python/examples/farm/check` runs them."""

import hashlib
import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any, Dict, Iterator, Optional, Tuple

import numpy as np
import pytest
from PIL import Image

import octagloss
import sizes

FARM = Path(__file__).with_name("farm.py")
HDR = Path(__file__).resolve().parents[3] / "hdr"
SMALL = ["--size", "16", "--levels", "3"]
# Ray's workers have a low priority by default, which a busy machine starves.
ENVIRONMENT = {**os.environ, "RAY_worker_niceness": "0"}


def write_panorama(path: Path, seed: int, height: int = 32) -> None:
    """A dim panorama with one lamp, as a Radiance file without compression: no value marks a run."""
    rng = np.random.default_rng(seed)
    texels = np.full((height, 2 * height, 4), 128, np.uint8)
    texels[..., :3] = rng.integers(8, 64, (height, 2 * height, 3))
    texels[rng.integers(height), rng.integers(2 * height)] = (255, 200, 150, 134)
    header = f"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {height} +X {2 * height}\n"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(header.encode() + texels.tobytes())


def write_panoramas(folder: Path, count: int) -> None:
    for at in range(count):
        write_panorama(folder / f"{at % 10}" / f"sky{at:03}.hdr", at, 64 if at % 5 == 0 else 32)


def farm(*arguments: object, code: int = 0, environment: Optional[Dict[str, str]] = None) -> str:
    command = [sys.executable, str(FARM), *map(str, arguments)]
    ran = subprocess.run(command, capture_output=True, text=True, env={**ENVIRONMENT, **(environment or {})})
    assert ran.returncode == code, ran.stdout + ran.stderr
    return ran.stdout


def records(baked: Path) -> Dict[str, Dict[str, Any]]:
    found = sorted(baked.rglob("farm.json"))
    return {str(path.parent.relative_to(baked)): json.loads(path.read_text()) for path in found}


def summary(baked: Path) -> Dict[str, Dict[str, Any]]:
    lines = map(json.loads, (baked / "summary.jsonl").read_text().splitlines())
    return {line["input"]: line for line in lines}


def whole(baked: Path, place: str, record: Dict[str, Any]) -> bool:
    """Whether all outputs of a record are there, of the recorded content."""
    for name, hashed in record["outcome"]["outputs"].items():
        file = baked / place / name
        if not file.is_file() or hashlib.sha256(file.read_bytes()).hexdigest() != hashed["sha256"]:
            return False
    return "farm.png" in record["outcome"]["outputs"] and len(record["outcome"]["outputs"]) >= 2


def versions(baked: Path) -> Dict[str, Tuple[int, int]]:
    """Replaced files have another inode or time."""
    stats = {path: path.stat() for path in baked.rglob("*.ktx2")}
    return {str(path.relative_to(baked)): (stat.st_ino, stat.st_mtime_ns) for path, stat in stats.items()}


def wait_for(process: "subprocess.Popen[str]", baked: Path, count: int) -> None:
    deadline = time.monotonic() + 300
    while len(list(baked.rglob("farm.json"))) < count:
        assert process.poll() is None, "the farm ended before it was interrupted"
        assert time.monotonic() < deadline, "the farm is stuck"
        time.sleep(0.02)


def latest_worker(baked: Path) -> int:
    """The process that wrote the latest record."""
    latest = max(baked.rglob("farm.json"), key=lambda path: path.stat().st_mtime_ns)
    worker: str = json.loads(latest.read_text())["outcome"]["worker"]
    return int(worker.split(":")[1])


def test_500_panoramas_survive_a_killed_worker_a_killed_driver_and_damage(tmp_path: Path) -> None:
    skies, baked = tmp_path / "skies", tmp_path / "baked"
    write_panoramas(skies, 500)
    command = [sys.executable, str(FARM), str(skies), str(baked), "--workers", "2", *SMALL]
    with (tmp_path / "log").open("w+") as log:
        process = subprocess.Popen(command, stderr=log, stdout=log, text=True, env=ENVIRONMENT)
        try:
            wait_for(process, baked, 120)
            killed = latest_worker(baked)
            before = records(baked)
            versions_before = versions(baked)
            os.kill(killed, signal.SIGKILL)
            # Others do the rest of its task.
            wait_for(process, baked, 300)
            workers = {record["outcome"]["worker"] for record in records(baked).values()}
        finally:
            process.kill()
            process.wait()
        # The killed driver's workers end with it; a record may follow.
        time.sleep(5)
        log.seek(0)
        assert "a worker ended in a task of" in log.read()
    assert len(workers) >= 3, "a new worker replaces the killed one"

    # What was whole when the worker was killed was not baked again.
    done = records(baked)
    assert 300 <= len(done) < 500
    versions_done = versions(baked)
    for place in before:
        file = f"{place}/{Path(place).name}.ktx2"
        assert versions_done[file] == versions_before[file], f"{place} was baked twice"
    assert all(whole(baked, place, record) for place, record in done.items())

    # Damage that neither size nor existence shows, a missing output, one cut short, a record cut short.
    flipped, missing, short, unrecorded = list(done)[:4]
    damaged_file = baked / flipped / f"{Path(flipped).name}.ktx2"
    content = bytearray(damaged_file.read_bytes())
    content[-1] ^= 1
    damaged_file.write_bytes(content)
    (baked / missing / f"{Path(missing).name}.ktx2").unlink()
    damaged_file = baked / short / f"{Path(short).name}.ktx2"
    damaged_file.write_bytes(damaged_file.read_bytes()[:-1])
    (baked / unrecorded / "farm.json").write_text('{"run"')
    damaged = {flipped, missing, short, unrecorded}

    printed = farm(skies, baked, "--workers", "2", *SMALL)
    assert printed.startswith(f"{500 - len(done) + 4} baked, {len(done) - 4} unchanged, 0 failed in ")
    lines = summary(baked)
    assert len(lines) == 500
    for name, line in lines.items():
        place = str(Path(name).with_suffix(""))
        assert line["status"] == ("unchanged" if place in done and place not in damaged else "baked"), name
    versions_after = versions(baked)
    for place in set(done) - damaged:
        file_name = f"{place}/{Path(place).name}.ktx2"
        assert versions_after[file_name] == versions_done[file_name], f"{place} was baked twice"

    # All 500 are whole, and nothing else is there.
    last = records(baked)
    assert len(last) == 500 and all(whole(baked, place, record) for place, record in last.items())
    assert not [path for path in baked.rglob(".farm-*")]
    for at in range(0, 500, 71):
        place = f"{at % 10}/sky{at:03}"
        environment = octagloss.Environment.from_file(skies / f"{place}.hdr")
        octagloss.bake(environment, size=16, levels=3, output=tmp_path / "one.ktx2", force=True)
        assert (baked / place / f"sky{at:03}.ktx2").read_bytes() == (tmp_path / "one.ktx2").read_bytes()
    with Image.open(baked / "sheet-1.png") as sheet:
        assert sheet.width > 1000 and len(sheet.resize((64, 64)).getcolors(4096) or []) > 50
    assert (baked / "summary.md").read_text().count("\n| ") == 501

    # A further run bakes nothing.
    assert farm(skies, baked, "--workers", "2", *SMALL).startswith("0 baked, 500 unchanged, 0 failed in ")
    assert versions(baked) == versions_after


def test_changed_inputs_and_options_are_baked_again(tmp_path: Path) -> None:
    skies, baked = tmp_path / "skies", tmp_path / "baked"
    for at in range(4):
        write_panorama(skies / f"{at}.hdr", at)
    assert farm(skies, baked, *SMALL).startswith("4 baked, 0 unchanged")
    write_panorama(skies / "2.hdr", 99)
    # The same content with another time.
    os.utime(skies / "3.hdr", (0, 0))
    assert farm(skies, baked, *SMALL).startswith("1 baked, 3 unchanged")
    assert farm(skies, baked, "--target", "three", "--size", 32).startswith("4 baked, 0 unchanged")
    # The former output is removed.
    names = sorted(path.name for path in (baked / "0").iterdir())
    assert names == ["0_pmrem.ktx2", "0_sh.json", "farm.json", "farm.png", "report.json"]


def test_failures_are_listed_and_the_rest_is_baked(tmp_path: Path) -> None:
    skies, baked = tmp_path / "skies", tmp_path / "baked"
    write_panorama(skies / "good.hdr", 1)
    (skies / "bad.hdr").write_bytes(b"#?RADIANCE\nnothing follows")
    (skies / "gone.hdr").symlink_to("/nowhere")
    assert farm(skies, baked, *SMALL, "--retries", "2", code=1).startswith("1 baked, 0 unchanged, 2 failed")
    lines = summary(baked)
    assert lines["good.hdr"]["status"] == "baked" and lines["good.hdr"]["error"] is None
    # Another attempt at a broken file would end the same; a file that cannot be opened may be there later.
    assert lines["bad.hdr"]["status"] == "failed" and lines["bad.hdr"]["attempts"] == 1
    assert "bad.hdr: truncated" in lines["bad.hdr"]["error"]
    assert lines["gone.hdr"]["status"] == "failed" and lines["gone.hdr"]["attempts"] == 3
    table = (baked / "summary.md").read_text().splitlines()
    assert table[0] == "1 baked, 0 unchanged, 2 failed." and table[6].startswith("| failed | bad.hdr")


def test_a_panorama_beyond_the_memory_of_all_nodes_is_tried(tmp_path: Path) -> None:
    write_panorama(tmp_path / "skies" / "a.hdr", 1)
    # Ray would wait for a node that is large enough.
    patched = "import sizes, farm; sizes.memory = lambda cost: 2**50; farm.main()"
    command = [sys.executable, "-c", patched, str(tmp_path / "skies"), str(tmp_path / "skies" / "baked")]
    for count in ["1 baked, 0 unchanged", "0 baked, 1 unchanged"]:
        ran = subprocess.run(
            [*command, *SMALL], cwd=FARM.parent, capture_output=True, text=True, env=ENVIRONMENT
        )
        assert ran.stdout.startswith(f"{count}, 0 failed"), ran.stderr


def test_inputs_of_one_name_are_refused(tmp_path: Path) -> None:
    write_panorama(tmp_path / "a.hdr", 1)
    write_panorama(tmp_path / "a.exr", 1)
    ran = subprocess.run(
        [sys.executable, str(FARM), str(tmp_path), str(tmp_path / "out")], capture_output=True, text=True
    )
    assert ran.returncode == 1 and "both would be baked into a" in ran.stderr
    ran = subprocess.run(
        [sys.executable, str(FARM), str(HDR / "none"), "out"], capture_output=True, text=True
    )
    assert ran.returncode == 1 and "no panoramas" in ran.stderr
    ran = subprocess.run([sys.executable, str(FARM), str(HDR), f"{HDR}/"], capture_output=True, text=True)
    assert ran.returncode == 1 and "choose another for the bakes" in ran.stderr


@pytest.fixture
def bucket() -> Iterator[Tuple[Any, Dict[str, str]]]:
    """An S3 server on the loopback device, and the environment that leads to it."""
    import fsspec
    from moto.server import ThreadedMotoServer

    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    host, port = server.get_host_and_port()
    environment = {
        "AWS_ENDPOINT_URL": f"http://{host}:{port}",
        "AWS_ACCESS_KEY_ID": "farm",
        "AWS_SECRET_ACCESS_KEY": "farm",
        "AWS_DEFAULT_REGION": "us-east-1",
    }
    files = fsspec.filesystem(
        "s3",
        key="farm",
        secret="farm",
        endpoint_url=environment["AWS_ENDPOINT_URL"],
        use_listings_cache=False,
    )
    files.mkdir("farm")
    yield files, environment
    server.stop()


def test_inputs_and_outputs_may_be_in_object_storage(
    bucket: Tuple[Any, Dict[str, str]], tmp_path: Path
) -> None:
    files, environment = bucket
    skies = tmp_path / "skies"
    for at in range(24):
        write_panorama(skies / f"{at % 3}" / f"{at}.hdr", at)
    for path in skies.rglob("*.hdr"):
        files.pipe_file(f"farm/skies/{path.relative_to(skies)}", path.read_bytes())
    places = ["s3://farm/skies", "s3://farm/baked"]
    assert farm(*places, *SMALL, environment=environment).startswith("24 baked, 0 unchanged, 0 failed")
    listed = files.find("farm/baked")
    assert Counter(path.rsplit(".", 1)[1] for path in listed) == {
        "ktx2": 24,
        "json": 24,
        "png": 25,
        "jsonl": 1,
        "md": 1,
    }

    # Equal to bakes of local files.
    assert farm(skies, tmp_path / "baked", *SMALL).startswith("24 baked")
    for path in (tmp_path / "baked").rglob("*.ktx2"):
        assert files.cat_file(f"farm/baked/{path.relative_to(tmp_path / 'baked')}") == path.read_bytes()

    content = bytearray(files.cat_file("farm/baked/1/4/4.ktx2"))
    content[-1] ^= 1
    files.pipe_file("farm/baked/1/4/4.ktx2", bytes(content))
    files.rm_file("farm/baked/2/5/5.ktx2")
    assert farm(*places, *SMALL, environment=environment).startswith("2 baked, 22 unchanged, 0 failed")
    assert files.cat_file("farm/baked/1/4/4.ktx2") == (tmp_path / "baked/1/4/4.ktx2").read_bytes()
    assert files.exists("farm/baked/2/5/5.ktx2")


def test_pixels_are_those_of_the_headers(tmp_path: Path) -> None:
    Image.new("RGB", (40, 20)).save(tmp_path / "a.png")
    write_panorama(tmp_path / "a.hdr", 1)
    for path, count in [(tmp_path / "a.png", 800), (tmp_path / "a.hdr", 2048), (HDR / "sky.exr", 512 * 256)]:
        assert sizes.pixels(path.read_bytes()[: sizes.HEADER], path.stat().st_size) == count
    assert sizes.pixels(b"", 5000) == 2500
    assert sizes.pixels(b"\xff\xd8\xff\xe0", 0) == 1


def test_tasks_have_equal_costs() -> None:
    costs = {f"{at}": 100 for at in range(50)}
    costs["large"] = 3000
    made = sizes.batches(costs, 1000, 2)
    assert made[0] == ["large"]
    assert sorted(name for names in made for name in names) == sorted(costs)
    # 8000 / (8 * 2) a task.
    assert {len(names) for names in made[1:]} == {5}
    assert [len(names) for names in sizes.batches(costs, 200, 1)[1:]] == [2] * 25
