"""Bakes thousands of panoramas on the workers of a Ray cluster, or on this machine's cores.

    python3 farm.py SKIES BAKED [--target three] [--size 256]

SKIES and BAKED are folders, or URLs of fsspec such as s3://bucket/skies. Each panorama is baked into a folder
of its name in BAKED. Run the same command again after any interruption: bakes whose outputs have the recorded
hashes are kept. docs/farms.md describes it.
"""

import argparse
import os
import secrets
import sys
import time
from collections import Counter
from typing import Any, Dict, List, Tuple

import ray
import sizes
import storage
import summary
import worker
from storage import Storage
from worker import Job, Outcome

# Texels that a level 0 of unknown size is assumed to have along an edge.
USUAL_SIZE = 256


def parsed() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Bakes the panoramas of a folder on a Ray cluster.")
    parser.add_argument("source", metavar="SKIES", help="folder or URL of the panoramas, and folders in it")
    parser.add_argument("output", metavar="BAKED", help="folder or URL of the bakes and the summary")
    parser.add_argument("--target", help="preset of an engine; default: a .ktx2 file each")
    parser.add_argument("--size", type=int, help="edge of level 0")
    parser.add_argument("--levels", type=int, help="number of levels")
    parser.add_argument("--pixel", help="pixel format")
    parser.add_argument("--address", help="Ray cluster, such as auto; default: this machine")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="workers on this machine")
    parser.add_argument("--threads", type=int, default=1, help="threads of each worker")
    parser.add_argument("--retries", type=int, default=3, help="further attempts of each panorama")
    parser.add_argument("--texels", type=int, default=8_000_000, help="texels of a task, sources and bakes")
    parser.add_argument("--wheel", help="wheel that the cluster's nodes install")
    arguments = parser.parse_args()
    for name in ["workers", "threads", "texels"]:
        if getattr(arguments, name) < 1:
            parser.error(f"--{name} is {getattr(arguments, name)}; it must be at least 1")
    return arguments


def inputs(source: Storage, output: Storage, size: int) -> Dict[str, int]:
    """The panoramas, and what each costs: the texels read and baked."""
    if source.root == output.root and type(source.fs) is type(output.fs):
        sys.exit(f"{output.root} is the folder of the panoramas; choose another for the bakes")
    # Outputs below the inputs are no inputs.
    inside = output.root[len(source.root) + 1 :] + "/" if output.root.startswith(source.root + "/") else None
    found = {
        name: file_bytes
        for name, file_bytes in source.sizes().items()
        if name.lower().endswith(sizes.SUFFIXES) and not (inside and name.startswith(inside))
    }
    owners: Dict[str, str] = {}
    for name in found:
        other = owners.setdefault(worker.stem(name), name)
        if other != name:
            folder = worker.stem(name)
            sys.exit(f"{source.path(other)} and {name}: both would be baked into {folder}; rename one")
    headers = source.beginnings(list(found), sizes.HEADER)
    baked = 8 * size * size
    return {name: baked + sizes.pixels(headers.get(name, b""), found[name]) for name in found}


def start(arguments: argparse.Namespace) -> Tuple[int, int]:
    """Starts Ray or joins a cluster; the number of workers, and the memory of the largest node in bytes."""
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    # The modules next to this file travel with the tasks.
    for module in [storage, worker]:
        ray.cloudpickle.register_pickle_by_value(module)  # type: ignore[no-untyped-call, unused-ignore]
    settings: Dict[str, Any] = {"log_to_driver": False, "logging_level": "ERROR"}
    if arguments.wheel:
        settings["runtime_env"] = {"py_modules": [arguments.wheel]}
    if arguments.address:
        ray.init(address=arguments.address, **settings)
    else:
        ray.init(num_cpus=arguments.workers * arguments.threads, include_dashboard=False, **settings)
    known: List[Dict[str, Any]] = ray.nodes()  # type: ignore[no-untyped-call, unused-ignore]
    nodes: List[Dict[str, float]] = [node["Resources"] for node in known if node["Alive"]]
    workers = sum(int(node.get("CPU", 0)) // int(arguments.threads) for node in nodes)
    if workers == 0:
        sys.exit(f"--threads is {arguments.threads}, more than any node of the cluster has; choose fewer")
    return workers, max(int(node.get("memory", 0)) for node in nodes)


class Run:
    """The tasks in progress, and the outcomes so far."""

    def __init__(self, job: Job, costs: Dict[str, int], retries: int, memory: int) -> None:
        self.job, self.costs, self.retries, self.memory = job, costs, retries, memory
        self.task = ray.remote(worker.work)
        self.pending: Dict[Any, List[str]] = {}
        self.attempts: Counter[str] = Counter()
        self.outcomes: Dict[str, Outcome] = {}

    def submit(self, names: List[str]) -> None:
        # Workers prepare one panorama at a time. Ray's own retries would repeat a whole task for one of them.
        # What is too large for every node is tried on the largest, alone.
        needed = min(sizes.memory(max(self.costs[name] for name in names)), self.memory)
        task = self.task.options(num_cpus=self.job.threads, memory=needed, max_retries=0)
        self.attempts.update(names)
        self.pending[task.remote(self.job, names)] = names

    def collect(self, done: Any) -> None:
        """Takes the outcomes of a task; submits again what may succeed."""
        names = self.pending.pop(done)
        try:
            outcomes: List[Outcome] = ray.get(done)
        except ray.exceptions.RayError as error:
            # The worker died. One panorama may be the cause: each gets a task of its own, which keeps what
            # is whole.
            reason = f"{type(error).__name__}: {str(error).strip().splitlines()[0]}"
            print(f"a worker ended in a task of {len(names)}: {reason}", file=sys.stderr)
            outcomes = [Outcome(name, "retry", error=reason) for name in names]
        for outcome in outcomes:
            outcome.attempts = self.attempts[outcome.input]
            if outcome.status == "retry" and outcome.attempts <= self.retries:
                self.submit([outcome.input])
            else:
                outcome.status = "failed" if outcome.status == "retry" else outcome.status
                self.outcomes[outcome.input] = outcome

    def finish(self) -> List[Outcome]:
        begun = shown = time.monotonic()
        while self.pending:
            done, _ = ray.wait(list(self.pending), timeout=1)
            for task in done:
                self.collect(task)
            now = time.monotonic()
            if now - shown >= 5 or not self.pending:
                shown = now
                rate = len(self.outcomes) / (now - begun)
                print(f"[{len(self.outcomes)}/{len(self.costs)}] {rate:.1f} a second", file=sys.stderr)
        return [self.outcomes[name] for name in sorted(self.outcomes)]


def absolute(place: str) -> str:
    """A path that workers understand, whose current folder is another."""
    return place if "://" in place else os.path.abspath(place)


def main() -> None:
    arguments = parsed()
    source, output = Storage(arguments.source), Storage(arguments.output)
    costs = inputs(source, output, arguments.size or USUAL_SIZE)
    if not costs:
        needed = ", ".join(sizes.SUFFIXES)
        sys.exit(f"{arguments.source}: no panoramas; files that end in {needed} are needed")
    given = {name: getattr(arguments, name) for name in ["target", "size", "levels", "pixel"]}
    options = {name: value for name, value in given.items() if value is not None}
    places = absolute(arguments.source), absolute(arguments.output)
    job = Job(secrets.token_hex(8), places[0], places[1], options, arguments.threads)
    workers, memory = start(arguments)
    run = Run(job, costs, arguments.retries, memory)
    begun = time.monotonic()
    for names in sizes.batches(costs, arguments.texels, workers):
        run.submit(names)
    outcomes = run.finish()
    wall = time.monotonic() - begun

    shown = ", ".join(f"{name} {value}" for name, value in options.items()) or "defaults"
    heading = f"{len(outcomes)} panoramas ({shown}): the source above, the level nearest roughness 0.5 below"
    output.write("summary.jsonl", summary.json_lines(outcomes))
    output.write("summary.md", summary.table(outcomes, wall))
    for at, picture in enumerate(summary.sheets(outcomes, heading), 1):
        output.write(f"sheet-{at}.png", picture)
    print(f"{summary.counts(outcomes)} in {wall:.1f} s; {arguments.output}/summary.md")
    sys.exit(any(outcome.status == "failed" for outcome in outcomes))


if __name__ == "__main__":
    main()
