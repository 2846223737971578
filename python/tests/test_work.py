"""Long work: interruptible, without the interpreter's lock, in any process."""

import multiprocessing
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import octagloss

# Each takes minutes.
LONG = {
    "bake": "octagloss.bake(sky, size=2048, filter='adaptive:0.00001')",
    "reflect": "sky.reflect(directions, 0.5, filter='adaptive:0.000001')",
    "reference": "octagloss.reference(sky, directions, 0.8)",
}

SCRIPT = """
import numpy as np, octagloss
random = np.random.default_rng(0)
sky = octagloss.Environment.from_array(random.random((256, 512, 3), np.float32))
directions = random.normal(size=(1_000_000, 3))
print("ready", flush=True)
{work}
print("done", flush=True)
"""


@pytest.mark.parametrize("work", LONG)
def test_ctrl_c_ends_it(work):
    script = SCRIPT.format(work=LONG[work])
    child = subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        assert child.stdout.readline() == "ready\n", child.stderr.read()
        time.sleep(0.7)
        assert child.poll() is None, "it ended before it was interrupted"
        start = time.monotonic()
        child.send_signal(signal.SIGINT)
        out, err = child.communicate(timeout=30)
        seconds = time.monotonic() - start
    finally:
        child.kill()
    assert "KeyboardInterrupt" in err and "done" not in out, err
    assert seconds < 3, f"{seconds} s until it ended"


def test_an_interrupted_bake_writes_nothing_and_the_next_works(lamp, tmp_path):
    # The alarm's handler raises, as that of Ctrl-C.
    class Alarm(Exception):
        pass

    def handler(number, frame):
        raise Alarm

    before = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(Alarm):
            octagloss.bake(lamp, size=2048, filter="adaptive:0.00001", output=tmp_path / "a.ktx2")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    octagloss.bake(lamp, size=8, levels=1, output=tmp_path / "b.ktx2")
    time.sleep(0.5)
    assert [path.name for path in tmp_path.iterdir()] == ["b.ktx2"]


def test_other_threads_go_on_meanwhile(sky, directions):
    ticks, end = [], threading.Event()

    def tick():
        while not end.wait(0.01):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    try:
        # One call that is long enough to measure.
        start, stop, count = 0.0, 0.0, 50
        while stop - start < 0.3:
            start = time.monotonic()
            octagloss.reference(sky, np.resize(directions, (count, 3)), 0.8)
            stop = time.monotonic()
            count *= 2
    finally:
        end.set()
        thread.join()
    meanwhile = [at for at in ticks if start < at < stop]
    assert len(meanwhile) > (stop - start) / 0.01 / 20, f"{len(meanwhile)} ticks in {stop - start} s"


def test_threads_may_share_an_environment(sky_file, directions):
    asked = [0.2, 0.5, 0.9]
    sky = octagloss.Environment.from_file(sky_file)
    expected = {roughness: sky.reflect(directions, roughness) for roughness in asked}
    wrong = []

    def ask(environment, roughness):
        if not np.array_equal(environment.reflect(directions, roughness), expected[roughness]):
            wrong.append(roughness)

    for _ in range(5):
        # All of them wait for tables that none has asked for before.
        fresh = octagloss.Environment.from_file(sky_file)
        threads = [threading.Thread(target=ask, args=(fresh, asked[k % 3]), daemon=True) for k in range(9)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
            assert not thread.is_alive(), "it hangs"
    assert wrong == []


def ask_in_child(environment, directions, queue):
    queue.put(environment.reflect(directions, 0.5))


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_forked_processes_have_threads_of_their_own(lamp, directions):
    expected = lamp.reflect(directions, 0.5)
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=ask_in_child, args=(lamp, directions, queue))
    child.start()
    answer = queue.get(timeout=30)
    child.join(30)
    np.testing.assert_array_equal(answer, expected)


def test_results_do_not_depend_on_threads(lamp, directions):
    expected = lamp.reflect(directions, 0.5)
    try:
        for count in [1, 3]:
            octagloss.set_threads(count)
            np.testing.assert_array_equal(lamp.reflect(directions, 0.5), expected)
        for count in [0, 257]:
            with pytest.raises(ValueError, match="1 to 256"):
                octagloss.set_threads(count)
    finally:
        octagloss.set_threads(None)
