"""Limits of memory, of the size of files and of CPU time (ulimit -v, -f, -t), full disks, and output without room."""

import os
import resource
import subprocess

from bench import DONE, NO_RESOURCES, Trial, disagreement, torn_files
from faults import judged
from kills import SHIM

MEGABYTE = 1 << 20


def limited(bench, i):
    which = ["-f", "-v", "-t"][i % 3]
    names = ["run", "study", "slope", "calibration", "draw a run", "envelope", "check"]
    name = "run" if which == "-t" else names[i // 3 % len(names)]
    words, rng, cwd = bench.jobs()[name], bench.rng("limits", i), bench.place("limited", i)
    if which == "-t":
        words = bench.run("quick.yaml", "--set", "stages.1.steps=20000", "--set", "output.checkpoint_every=0",
                          "--set", "output.fields=false")
        return out_of_time(bench, words, cwd)
    kind, bound = ((resource.RLIMIT_FSIZE, int(10 ** rng.uniform(2.5, 6))) if which == "-f"
                   else (resource.RLIMIT_AS, rng.randint(120, 460) * MEGABYTE))
    end = bench.call(words, cwd, limits=[(kind, bound)])
    if end.code == 127 and "shared libraries" in end.err:
        return Trial(f"ulimit {which}, {name}, too little to start", [])
    trial = judged(bench, name, words, cwd, end, None, torn_files(cwd))
    return Trial(f"ulimit {which}, {trial.outcome}", trial.problems, f"(ulimit {which} {bound // 1024}; {trial.command})")


def out_of_time(bench, words, cwd):
    """The soft limit asks the run to stop (SIGXCPU) and leaves it a state."""
    end = bench.call(words, cwd, limits=[(resource.RLIMIT_CPU, (1, 5))])
    problems = end.crash() + disagreement(end.code, cwd / "out") + torn_files(cwd)
    if end.code != 152:
        problems.append(f"exit {end.code} instead of 152: {end.said()}")
    if not (cwd / "out/state.h5").exists():
        problems.append("no state")
    return Trial(f"ulimit -t, exit {end.code}", problems, f"(ulimit -S -t 1; {bench.shell(words)})")


def full_disks(bench, i):
    name = ["run", "study", "calibration", "slope"][i % 4]
    words, rng, cwd = bench.jobs()[name], bench.rng("full disk", i), bench.place("full_disks", i)
    kilobytes = int(10 ** rng.uniform(1, 2.8))
    out = cwd / "out"
    out.mkdir()
    mounted = os.geteuid() == 0 and subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "none", str(out)],
                                                   capture_output=True).returncode == 0
    if mounted:
        try:
            end = bench.call(words, cwd)
            subprocess.run(["mount", "-o", "remount,size=100m", str(out)], check=True, capture_output=True)  # room is made
            trial = judged(bench, name, words, cwd, end, None, torn_files(cwd))
        finally:
            subprocess.run(["umount", "-l", str(out)], check=True)
        return Trial(f"{trial.outcome}", trial.problems, f"mount -t tmpfs -o size={kilobytes}k none out; {trial.command}")
    env = {"LD_PRELOAD": bench.library(SHIM), "KLUFT_CALL": "write", "KLUFT_CALL_BELOW": out, "KLUFT_CALL_AT": rng.randint(1, 100),
           "KLUFT_CALL_FOR": 0}
    return judged(bench, name, words, cwd, bench.call(words, cwd, env=env), env, [])


def output_without_room(bench, i):
    """Standard output on a full device: exit code 4 and a message. Closed, or with nobody who reads: no matter."""
    way, jobs = ["full", "unread", "closed"][i % 3], bench.jobs()
    name = [*jobs, "help"][i // 3]
    words = [word for word in jobs.get(name, ["--help"]) if word != "--quiet"]
    cwd = bench.place("output_without_room", i)
    if way == "closed":
        code = subprocess.run(["sh", "-c", '"$@" >&- 2>&-', "sh", str(bench.kluft), *words], cwd=cwd, stdin=subprocess.DEVNULL).returncode
        problems = [] if code == DONE else [f"exit {code}"]
    elif way == "unread":
        reading, writing = os.pipe()
        os.close(reading)
        code = bench.call(words, cwd, out=writing, err=writing).code
        os.close(writing)
        problems = [] if code == DONE else [f"exit {code}"]
    else:
        with open("/dev/full", "w") as full:
            end = bench.call(words, cwd, out=full)
        code = end.code
        problems = [] if code == NO_RESOURCES and "No space left" in end.err else [f"exit {code}: {end.said()}"]
    return Trial(f"{way}, {name}, exit {code}", problems + torn_files(cwd), bench.shell(words) + {"full": " >/dev/full", "unread": " 2>&1 | true",
                                                                                             "closed": " >&- 2>&-"}[way])


KINDS = {"limits of memory, files and time": (limited, 2, None), "full disks": (full_disks, 2, None),
         "output without room": (output_without_room, 1, 33)}
