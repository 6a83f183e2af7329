"""Calls on files and allocations that fail: the n-th one, alone or with all after it."""

import errno

from bench import DONE, MISSED, NO_RESOURCES, Trial, differences, disagreement, torn_files
from kills import SHIM

MEMORY = "tests/support/failing_memory.c"
CALLS = {"write": errno.ENOSPC, "fsync": errno.EIO, "rename": errno.ENOSPC, "open": errno.ENOSPC, "close": errno.EIO,
         "ftruncate": errno.EIO}


def calls(bench, i):
    name = ["run", "study", "run", "calibration", "run", "slope"][i % 6]
    words, rng, cwd = bench.jobs()[name], bench.rng("calls", i), bench.place("calls", i)
    call = rng.choice([*CALLS, "write", "write", "write"])
    n = bench.count(words, SHIM, "KLUFT_CALL_COUNT", KLUFT_CALL=call, KLUFT_CALL_BELOW="{cwd}/out")
    how_many = rng.choice([1, 1, 2, 0])
    env = {"LD_PRELOAD": bench.library(SHIM), "KLUFT_CALL": call, "KLUFT_CALL_BELOW": cwd / "out", "KLUFT_CALL_FOR": how_many,
           "KLUFT_CALL_AT": rng.randint(1, max(1, n)), "KLUFT_CALL_ERRNO": CALLS[call], "KLUFT_CALL_HALF": int(rng.random() < 0.3)}
    end = bench.call(words, cwd, env=env)
    torn = [] if call in ("ftruncate", "open", "write") and how_many != 1 else torn_files(cwd)  # what cannot even be taken back
    return judged(bench, name, words, cwd, end, env, torn)


def judged(bench, name, words, cwd, end, env, torn):
    """Done in spite of the fault, or exit code 4 with a message (1 of a study, which goes on with its other cases); then the same command goes on."""
    problems = end.crash() + torn
    if end.code == NO_RESOURCES or (end.code == MISSED and name == "study"):
        problems += [] if end.err.strip() or end.out.strip() else ["no message"]
    elif not end.crash() and end.code != DONE:
        problems.append(f"exit {end.code}: {end.said()}")
    if words[0] == "run":
        problems += disagreement(end.code, cwd / "out")
    if words[0] in ("run", "study", "calibrate") and (cwd / "out").exists():
        if end.code == DONE:
            problems += differences(cwd / "out", bench.reference(words), words)
        problems += bench.goes_on(words, cwd)
    return Trial(f"{name}, exit {end.code}", problems, bench.shell(words, env))


def allocations(bench, i):
    jobs = bench.jobs()
    name = list(jobs)[i % len(jobs)]
    words, rng, cwd = jobs[name], bench.rng("allocations", i), bench.place("allocations", i)
    n = bench.count(words, MEMORY, "KLUFT_FAIL_COUNT")
    at = rng.choice([rng.randint(1, n), int(n ** rng.random()), n - int(n ** rng.random())])
    env = {"LD_PRELOAD": bench.library(MEMORY), "KLUFT_FAIL_AT": max(1, at), "KLUFT_FAIL_FOR": rng.choice([0, 1])}
    end = bench.call(words, cwd, env=env)
    return judged(bench, name, words, cwd, end, env, torn_files(cwd))


KINDS = {"calls on files that fail": (calls, 4, None), "allocations that fail": (allocations, 15, None)}
