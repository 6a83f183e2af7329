"""Runs that must give the same numbers: resumed after each step, repeated with other threads, and very long."""

import json
import os
import time
from pathlib import Path

from bench import DONE, QUIET, Trial, differences, ended
from kills import SHIM
import hard


def five_scenes(bench):
    """Words of runs that save a state after each load step."""
    triaxial = hard.scenes.triaxial(steps=4, solver={}, update="event") | {"output": QUIET}
    net = hard.random_map(5, 1)
    collapse = hard.scenes.triaxial(steps=6, solver={}, update="event")
    collapse["stages"][1] = {"name": "load", "stress": {"boundary": "top", "value": 2.5e6}, "steps": 6}
    column = hard.scenes.column(steps=6, strain=1e-3)
    scenes = {"hexagons": triaxial, "map": net, "collapse": collapse, "column": column}
    always = {"checkpoint_every": 1, "checkpoint_seconds": 0}
    for name, scene in scenes.items():
        path = bench.models / f"each-{name}.yaml"
        if not path.exists():
            path.write_text(json.dumps(scene | {"output": QUIET | always, "solver": {**scene["solver"], "repeatable": True}}))
    return [bench.run(f"each-{name}.yaml") for name in scenes] + [bench.run("slope.yaml", "--set", "output.checkpoint_every=1")]


def resumed(bench, i):
    """The run is killed after each state in turn, the (n + 1)-th before it is in place."""
    runs = five_scenes(bench)
    words, step = runs[i % len(runs)], i // len(runs)
    cwd = bench.place("resumed", i)
    n = bench.count(words, SHIM, "KLUFT_CALL_COUNT", KLUFT_CALL="rename", KLUFT_CALL_BELOW="{cwd}/out/state.h5")
    name = Path(words[1]).stem
    if step + 2 > n:
        return None
    bench.call(words, cwd, env={"LD_PRELOAD": bench.library(SHIM), "KLUFT_CALL": "rename", "KLUFT_CALL_AT": step + 2, "KLUFT_CALL_ERRNO": 0,
                                "KLUFT_CALL_BELOW": cwd / "out/state.h5"})
    problems = [] if (cwd / "out/state.h5").exists() else ["no state"]
    return Trial(f"{name} after state {step + 1}", problems + bench.goes_on(words, cwd), bench.shell(words))


def threads(bench, i):
    """Repeated with one thread and with two: the same bits."""
    words, cwd, count = [bench.run(), five_scenes(bench)[0]][i % 2], bench.place("threads", i), 1 + i // 2 % 2
    end = bench.call([*words, "--threads", str(count)], cwd)
    reference = bench.reference(words)
    problems = end.crash() or ([] if end.code == DONE else [f"exit {end.code}: {end.said()}"]) or differences(cwd / "out", reference, words)
    return Trial(f"{Path(words[1]).stem}, {count} threads", problems, bench.shell([*words, "--threads", str(count)]))


N_STEPS = 10000


def long_run(bench, i):
    """Ten thousand load steps: neither memory nor time per step grow."""
    scene = hard.scenes.column(strain=1e-3, steps=N_STEPS, joints=[(i + 0.5) / 16 for i in range(16)], solver={}) | {"output": QUIET}
    cwd = bench.place("long_run", i)
    (cwd / "scene.yaml").write_text(json.dumps(scene))
    words = ["run", str(cwd / "scene.yaml"), "-o", "out", "--quiet"]
    process = bench.start(words, cwd)
    samples = []  # rows, bytes, s of CPU time
    while process.poll() is None:
        try:
            samples.append((last_step(cwd / "out/history.csv"), *use_of(process.pid)))
        except (OSError, ValueError, IndexError):
            pass
        time.sleep(0.02)
    end = ended(process)
    problems = end.crash() or ([] if end.code == DONE else [f"exit {end.code}: {end.said()}"])
    early, late = [[s for s in samples if low * N_STEPS <= s[0] <= high * N_STEPS] for low, high in ((0.1, 0.4), (0.7, 0.999))]  # not the end: the summary reads the tables
    if min(len(early), len(late)) < 2 or problems:
        return Trial(f"{N_STEPS} steps, {len(samples)} samples", problems or ["too few samples"], bench.shell(words))
    grown = max(s[1] for s in late) - max(s[1] for s in early)
    slower = time_per_step(late) / time_per_step(early)
    problems += [f"{grown / 1e6:.1f} MB more memory"] if grown > 2e6 else []
    problems += [f"{slower:.2f} times the time per step"] if slower > 1.5 else []
    return Trial(f"{N_STEPS} steps: {grown / 1e6:+.1f} MB, {slower:.2f} times the time per step at the end", problems, bench.shell(words))


def last_step(path):
    """The first number of the last whole row."""
    with open(path, "rb") as file:
        file.seek(max(0, path.stat().st_size - 2000))
        return int(file.read().split(b"\n")[-2].split(b",")[0])


def use_of(pid):
    """Resident bytes and CPU seconds of a process."""
    with open(f"/proc/{pid}/stat") as file:
        words = file.read().rsplit(")", 1)[1].split()
    return int(words[21]) * os.sysconf("SC_PAGE_SIZE"), (int(words[11]) + int(words[12])) / os.sysconf("SC_CLK_TCK")


def time_per_step(samples):
    return (samples[-1][2] - samples[0][2]) / max(1, samples[-1][0] - samples[0][0])


KINDS = {"resumed after each step": (resumed, 2, 60), "repeated with 1 and 2 threads": (threads, 1, 40), "ten thousand steps": (long_run, 1, 1)}
