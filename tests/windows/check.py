"""Checks of the Windows program under Wine; tests/windows/run calls it.

    check.py FOLDER NATIVE     FOLDER: octagloss.exe and hdr; NATIVE: this system's program
"""
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

FOLDER, NATIVE = Path(sys.argv[1]).resolve(), sys.argv[2]
SMALL = "--size 16 --levels 2 --filter adaptive:0.5 --engine cpu --quiet".split()
KILLS = int(os.environ.get("KILLS", "200"))
os.chdir(FOLDER)
failures = checks = 0


def started(*args, **more):
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    return subprocess.Popen(["wine", FOLDER / "octagloss.exe", *args], **{**pipes, **more})


def run(*args, **more):
    """Exit status, standard output and standard error."""
    process = started(*args, **more)
    out, err = process.communicate(timeout=120)
    return process.returncode, out, err.decode(errors="replace")


def check(holds, what):
    global failures, checks
    checks += 1
    if not holds:
        failures += 1
        print("FAILED", what, flush=True)


def bakes(*args, what=None, small=SMALL, **more):
    code, _, err = run("bake", *args, *small, **more)
    check(code == 0, f"{what or args}: exit {code}: {err.strip()}")


def refuses(words, *args, code=1, **more):
    """A run that fails with one line that has `words`."""
    got, _, err = run(*args, **more)
    lines = [line for line in err.splitlines() if line.startswith("octagloss: error: ")]
    check(got == code and len(lines) == 1 and words in lines[0], f"{args}: exit {got}: {err.strip()}")


def windows(path):
    """The path as Windows programs see it."""
    return "Z:" + str(Path(path).resolve()).replace("/", "\\")


def native(*args):
    subprocess.run([NATIVE, *args], check=True, stderr=subprocess.DEVNULL)


def same_bytes():
    """Every format, and every target, as on this system."""
    listed = subprocess.run([NATIVE, "bake", "x", "--target", "none"], capture_output=True, text=True).stderr
    targets = re.sub(r".*(there are|: )", "", listed.strip()).rstrip(".").replace(",", " ").split()
    check(len(targets) > 10, f"the targets {targets}")
    ways = [["-o", "sky.ktx2"], ["-o", "sky.dds", "--pixel", "bc6h"], ["-o", "exr", "--format", "exr"]]
    ways = [(["hdr/sky.exr", *way], way[1], []) for way in ways]
    few = ["--size", "64", "--filter", "adaptive:0.05"]
    ways += [(["hdr/studio.hdr", "-o", name, "--target", name], name, few) for name in targets]
    for args, output, more in ways:
        more = [*more, "--engine", "cpu", "--quiet"]
        for folder, program in [("ours", ["wine", FOLDER / "octagloss.exe"]), ("theirs", [NATIVE])]:
            os.makedirs(folder, exist_ok=True)
            shutil.copytree("hdr", f"{folder}/hdr", dirs_exist_ok=True)
            command = [*program, "bake", *args, *more]
            subprocess.run(command, cwd=folder, check=True, stderr=subprocess.DEVNULL)
        ours, theirs = [state(Path(folder), output) for folder in ["ours", "theirs"]]
        check(ours and set(ours) == set(theirs), f"files of {args}: {sorted(ours)}")
        for name in set(ours) & set(theirs):
            is_report = name.endswith("report.json")
            same = alike(ours[name], theirs[name]) if is_report else ours[name] == theirs[name]
            check(same, f"bytes of {args}: {name}")


def alike(ours, theirs):
    """Whether reports differ in the last digits of numbers only, and in what follows from these: sines and
    powers of two systems differ there."""
    differing = [(a, b) for a, b in zip(ours, theirs) if a != b and b'"report":' not in a]
    pairs = [(a.decode(), b.decode()) for a, b in differing]
    number = re.compile(r"-?\d+\.?\d*(?:e-?\d+)?")
    texts = all(number.sub("", a) == number.sub("", b) for a, b in pairs)
    values = [[float(text) for pair in pairs for text in number.findall(pair[k])] for k in (0, 1)]
    close = all(abs(a - b) <= 1e-6 * abs(b) + 1e-12 for a, b in zip(*values))
    return len(ours) == len(theirs) and texts and len(values[0]) == len(values[1]) and close


def state(folder, output=""):
    """Files and their bytes, but the lines of reports that differ from run to run."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and name.startswith(output) and ".octagloss-" not in name:
            lines = path.read_bytes().split(b"\n")
            own = [line for line in lines if b'"seconds"' not in line and b'"created"' not in line]
            found[name] = own if name.endswith(".json") else lines
    return found


def paths():
    os.mkdir("p")
    shutil.copy("hdr/sky.exr", "p/sky.exr")
    here = windows("p")
    bakes(r"p\sky.exr", "-o", r"p\backslashes.ktx2")
    bakes("p/sky.exr", "-o", r".\p/mixed.ktx2")
    bakes(here + r"\sky.exr", "-o", here + r"\drive.ktx2")
    bakes(rf"\\?\{here}\sky.exr", "-o", rf"\\?\{here}\verbatim.ktx2")
    bakes(r"p\sky.exr", "-o", "p\\folder\\")
    bakes(r"p\sky.exr", "-o", "p\\\u00fcml\u00e4ut.ktx2")
    for name in ["backslashes", "mixed", "drive", "verbatim", "folder/sky", "\u00fcml\u00e4ut"]:
        check(Path("p", f"{name}.ktx2").is_file(), f"no p/{name}.ktx2")
    # In a verbatim path `?` is no wildcard.
    refuses("none.exr", "bake", rf"\\?\{here}\none.exr", "-o", r"p\x.ktx2", *SMALL)
    _, _, err = run("bake", rf"\\?\{here}\none.exr", "-o", r"p\x.ktx2", *SMALL)
    check("matches no" not in err, f"a verbatim path is no pattern: {err}")
    # Patterns are expanded by the program, without regard to case.
    shutil.copy("hdr/sky.exr", "p/Second.EXR")
    bakes(r"p\*.exr", "-o", r"p\glob")
    matched = sorted(path.name for path in Path("p/glob").glob("*.ktx2"))
    check(matched == ["Second.ktx2", "sky.ktx2"], f"p\\*.exr: {matched}")
    os.mkdir("p/sub")
    shutil.copy("hdr/sky.exr", "p/sub/SKY.exr")
    # Names that differ in case are one.
    refuses("would both be written", "bake", r"p\sky.exr", r"p\sub\SKY.exr", "-o", r"p\both", *SMALL, code=2)


def names():
    os.mkdir("n")
    for name in ["aux.ktx2", "NUL", "com1.ktx2", "nul.tar.ktx2"]:
        refuses("a device of Windows", "bake", "hdr/sky.exr", "-o", f"n\\{name}", *SMALL)
    for name in ["what<.ktx2", "a|b.ktx2", "a:b.ktx2"]:
        refuses("does not allow", "bake", "hdr/sky.exr", "-o", f"n\\{name}", *SMALL)
    for name in ["sky.ktx2.", "sky.ktx2 "]:
        refuses("full stop or a space", "bake", "hdr/sky.exr", "-o", f"n\\{name}", "--format", "ktx2", *SMALL)
    check(not os.listdir("n"), f"refused outputs left {os.listdir('n')}")
    shutil.copy("hdr/sky.exr", "aux.exr")
    refuses("device AUX", "info", "aux.exr")
    refuses("device NUL", "info", "NUL")
    code, out, _ = run("info", "--json", rf"\\?\{windows('aux.exr')}")
    check(code == 0 and b"panorama" in out, "aux.exr behind the prefix")


def texts():
    rows = "x,y,z\n0,1,0\n1,0,0\n"
    frames = "nx,ny,nz,vx,vy,vz\n0,1,0,0,1,0\n0,1,0,1,1,0\n"
    for name, text, option in [("d", rows, "--directions"), ("f", frames, "--frames")]:
        outputs = []
        for end in ["\n", "\r\n"]:
            Path(f"{name}.csv").write_bytes(text.replace("\n", end).encode())
            more = ["--roughness", "0.5"] + (["--filter", "pyramid"] if option == "--frames" else [])
            code, out, err = run("query", "hdr/sky.exr", option, f"{name}.csv", *more)
            check(code == 0, f"{option} with {end!r}: {err}")
            outputs.append(out)
        check(outputs[0] == outputs[1] and outputs[0].count(b"\n") == 3, f"{option} with CRLF: {outputs}")
        with open(f"{name}.csv", "rb") as text:
            code, out, err = run("query", "hdr/sky.exr", option, "-", *more, stdin=text)
        check(out == outputs[0], f"{option} - with CRLF: {err}")
    # Binary data passes standard output as it is.
    code, out, _ = run("bake", "hdr/sky.exr", "-o", "-", *SMALL)
    native("bake", "hdr/sky.exr", "-o", "piped.ktx2", *SMALL)
    check(out == Path("piped.ktx2").read_bytes(), "bytes of -o -")
    # No colours and no progress in pipes.
    code, _, err = run("bake", "hdr/sky.exr", "-o", "plain.ktx2", *SMALL[:-1])
    check(code == 0 and "\x1b" not in err, f"escapes: {err!r}")


def read_only():
    os.mkdir("r")
    bakes("hdr/sky.exr", "-o", r"r\sky.ktx2")
    before = Path("r/sky.ktx2").read_bytes()
    os.chmod("r/sky.ktx2", 0o444)
    refuses("is read-only", "bake", "hdr/sky.exr", "-o", r"r\sky.ktx2", "--force", *SMALL)
    check(Path("r/sky.ktx2").read_bytes() == before, "a read-only file is kept")
    os.chmod("r/sky.ktx2", 0o644)


def held():
    """Files that another program has open: for longer than renames wait, and for less."""
    os.mkdir("h")
    bakes("hdr/sky.exr", "-o", r"h\sky.ktx2")
    before = Path("h/sky.ktx2").read_bytes()
    turned = ["bake", "hdr/sky.exr", "-o", r"h\sky.ktx2", "--force", "--rotate-y", "90", *SMALL]
    for seconds in [30, 0.4]:
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        holder = subprocess.Popen(["wine", FOLDER / "hold.exe", r"h\sky.ktx2"], **pipes)
        check(holder.stdout.readline().strip() == b"open", "the file is held")
        if seconds > 1:
            refuses("another program may have it open", *turned)
            check(Path("h/sky.ktx2").read_bytes() == before, "a file in use is kept")
            holder.communicate()
        else:
            process = started(*turned)
            while process.poll() is None and not leftovers("h"):
                pass
            time.sleep(seconds)
            holder.communicate()
            _, err = process.communicate(timeout=60)
            check(process.returncode == 0, f"a file in use for {seconds} s: {err}")
        check(not leftovers("h"), f"leftovers {leftovers('h')}")
    check(Path("h/sky.ktx2").read_bytes() != before, "a file is replaced when it is no longer in use")


def leftovers(folder):
    return [name for name in os.listdir(folder) if name.startswith(".octagloss-")]


def running(word):
    """The process of this system in which octagloss.exe runs with the argument `word`, once it does."""
    for _ in range(200):
        for process in filter(str.isdigit, os.listdir("/proc")):
            try:
                arguments = Path("/proc", process, "cmdline").read_text().split("\0")
            except OSError:
                continue
            if arguments[0].endswith("octagloss.exe") and word in arguments:
                return int(process)
        time.sleep(0.05)
    raise RuntimeError(f"octagloss.exe did not start with {word}")


def interrupted():
    os.mkdir("c")
    # The status is asked of Windows. This system sees its last eight bits, or a kill: Wine's server kills
    # programs that take longer than half a second to go after they have given their status.
    bake = ["octagloss.exe", "bake", "hdr/sky.exr", "-o", r"c\sky.ktx2", "--filter", "reference", "--quiet"]
    process = subprocess.Popen(["wine", FOLDER / "status.exe", *bake], stdout=subprocess.PIPE)
    program = running(r"c\sky.ktx2")
    time.sleep(1.5)
    os.kill(program, signal.SIGINT)
    status = process.communicate(timeout=60)[0].strip()
    # STATUS_CONTROL_C_EXIT.
    check(status == b"c000013a", f"Ctrl-C: status {status}")
    check(not os.listdir("c"), f"Ctrl-C leaves {os.listdir('c')}")
    # While outputs are written, too.
    caught = 0
    for _ in range(20):
        process = started("bake", "hdr/sky.exr", "-o", r"c\out", "--format", "exr", "--force", *SMALL)
        while process.poll() is None and not leftovers("c"):
            pass
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=60)
        caught += process.returncode != 0
        check(not leftovers("c"), f"Ctrl-C leaves {leftovers('c')}")
        for name in leftovers("c"):
            shutil.rmtree(f"c/{name}", ignore_errors=True)
    print(f"Ctrl-C: {caught} of 20 runs were interrupted while they wrote")


def two_steps():
    """What a kill between the two renames of a folder leaves, which the next run restores."""
    os.mkdir("s")
    bakes("hdr/sky.exr", "-o", r"s\out", "--format", "exr")
    old = state(Path("s"))
    stem = "s/.octagloss-abc123"
    shutil.copytree("s/out", stem + ".new")
    os.rename("s/out", stem + ".old")
    Path(stem + ".lock").write_bytes(b"out")
    code, _, err = run("bake", "hdr/sky.exr", "-o", r"s\out", "--format", "exr", *SMALL[:-1])
    check(code == 1 and "restored" in err and "already exists" in err, f"restoring: exit {code}: {err}")
    check(r"\\?" not in err, f"a path with a prefix: {err}")
    check(state(Path("s")) == old and not leftovers("s"), f"restored {os.listdir('s')}")


def between():
    """A real kill between the two renames of a folder. Wine's server renames for the program: strace holds it
    back for two seconds after each rename."""
    os.mkdir("b")
    bakes("hdr/sky.exr", "-o", r"b\out", "--format", "exr")
    old = state(Path("b"))
    turned = ["bake", "hdr/sky.exr", "-o", r"b\out", "--format", "exr", "--rotate-y", "90", *SMALL]
    held = "inject=rename,renameat,renameat2:delay_exit=2000000"
    trace = ["strace", "-f", "-qq", "-o", "renames.txt", "-e", held, "-p", str(server())]
    tracer = subprocess.Popen(trace)
    process = started(*turned, "--force")
    for _ in range(600):
        if not os.path.exists("b/out"):
            break
        time.sleep(0.05)
    process.kill()
    process.wait()
    tracer.send_signal(signal.SIGINT)
    tracer.wait(timeout=60)
    kinds = sorted(name.rsplit(".", 1)[1] for name in leftovers("b"))
    is_between = not os.path.exists("b/out") and kinds == ["lock", "new", "old"]
    check(is_between, f"killed between: {os.listdir('b')}")
    code, _, err = run("bake", "hdr/sky.exr", "-o", r"b\out", "--format", "exr", *SMALL[:-1])
    check(code == 1 and "restored" in err and "already exists" in err, f"restoring: exit {code}: {err}")
    check(state(Path("b")) == old and not leftovers("b"), f"restored {os.listdir('b')}")
    bakes(*turned[1:], "--force", what="after a kill between the renames", small=[])
    check(state(Path("b")) != old and not leftovers("b"), f"then {os.listdir('b')}")


def server():
    """The process of Wine's server that serves this prefix: it runs in a folder that is named after it."""
    found = os.stat(os.environ["WINEPREFIX"])
    folder = f"server-{found.st_dev:x}-{found.st_ino:x}"
    for process in filter(str.isdigit, os.listdir("/proc")):
        try:
            if os.readlink(f"/proc/{process}/cwd").endswith(folder):
                return int(process)
        except OSError:
            pass
    raise RuntimeError("Wine's server does not run")


def killed():
    """Kills bakes at random while they replace a folder and a file with its report."""
    options = [["-o", r"k\out", "--format", "exr"], ["-o", r"k\out.ktx2", "--irradiance", "4"]]
    seen = {}
    for number, option in enumerate(options):
        trees = []
        for turned in [[], ["--rotate-y", "90"]]:
            shutil.rmtree("k", ignore_errors=True)
            os.mkdir("k")
            bakes("hdr/sky.exr", *option, *turned)
            trees.append(state(Path("k")))
            if not turned:
                shutil.rmtree("k.old", ignore_errors=True)
                shutil.copytree("k", "k.old")
        old, new = trees
        check(old != new, "old and new are equal")
        for kill in range(KILLS // 2):
            shutil.rmtree("k")
            shutil.copytree("k.old", "k")
            process = started("bake", "hdr/sky.exr", *option, "--rotate-y", "90", "--force", *SMALL)
            while process.poll() is None and not leftovers("k"):
                pass
            time.sleep(random.uniform(0, 0.03))
            process.kill()
            process.wait()
            verdict = judged(old, new)
            seen[verdict] = seen.get(verdict, 0) + 1
            allowed = ["old", "new", "missing"] if number == 0 else ["old", "new", "mixed"]
            check(verdict in allowed, f"kill {kill} of {option}: {verdict}: {os.listdir('k')}")
            run("bake", "hdr/sky.exr", *option, *SMALL)
            after = judged(old, new)
            check(after == verdict or (verdict == "missing" and after == "old"), f"then {after}")
            bakes("hdr/sky.exr", *option, "--rotate-y", "90", "--force", what="after a kill")
            check(judged(old, new) == "new" and not leftovers("k"), f"then {os.listdir('k')}")
    print("killed:", seen)


def judged(old, new):
    """Old, new, missing, mixed (each file is old or new) or torn."""
    now = state(Path("k"))
    if now == old or now == new:
        return "old" if now == old else "new"
    if not now:
        return "missing"
    whole = set(now) == set(old) and all(now[name] in [old[name], new[name]] for name in now)
    return "mixed" if whole else "torn"


for part in [same_bytes, paths, names, texts, read_only, held, interrupted, two_steps, between, killed]:
    begun = time.monotonic()
    part()
    print(f"{part.__name__}: {time.monotonic() - begun:.0f} s, {failures} failures", flush=True)
print(f"{checks} checks, {failures} failures")
sys.exit(failures > 0)
