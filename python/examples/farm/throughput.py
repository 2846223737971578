"""Measures the throughput of two local workers against one.

    python3 throughput.py [COUNT]

COUNT panoramas of 512 x 256, by default 120, are baked for three.js at 128 x 128; each worker has one thread.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from test_farm import ENVIRONMENT, FARM, write_panorama


def measured(skies: Path, baked: Path, workers: int) -> float:
    """Panoramas a second, without the start of Ray and its workers: from the first record to the last."""
    command = [sys.executable, str(FARM), str(skies), str(baked), "--workers", str(workers)]
    subprocess.run([*command, "--target", "three", "--size", "128"], check=True, env=ENVIRONMENT)
    records = sorted(baked.rglob("farm.json"), key=lambda path: path.stat().st_mtime_ns)
    used = {json.loads(path.read_text())["outcome"]["worker"] for path in records}
    assert len(used) == workers, f"{len(used)} workers baked, not {workers}"
    times = [path.stat().st_mtime_ns * 1e-9 for path in records]
    # The first of each worker is baked before the clock starts.
    return (len(times) - workers) / (times[-1] - times[workers - 1])


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 120
    with tempfile.TemporaryDirectory() as folder:
        skies = Path(folder) / "skies"
        for at in range(count):
            write_panorama(skies / f"{at}.hdr", at, 256)
        one = measured(skies, Path(folder) / "one", 1)
        two = measured(skies, Path(folder) / "two", 2)
    print(f"{one:.2f} panoramas a second with one worker, {two:.2f} with two: {two / one:.2f} times as many")


if __name__ == "__main__":
    main()
