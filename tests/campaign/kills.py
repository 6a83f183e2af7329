"""SIGKILL at random moments of every kind of run, at a call on a file or by the clock, then the same command again."""

import time

from bench import Trial, ended, torn_files

SHIM = "tests/campaign/failing_calls.c"


def kills(bench, i):
    name = ["run", "study", "run --resume", "calibration", "slope", "explicit"][i % 6]
    rng, cwd = bench.rng("kills", i), bench.place("kills", i)
    words = bench.jobs()[name.split()[0]]
    killed(bench, words, cwd, rng, by_clock=rng.random() < 0.3)
    problems = torn_files(cwd, killed=True)
    if "--resume" in name and (cwd / "out/state.h5").exists():
        words = [*words, "--resume"]
        killed(bench, words, cwd, rng, by_clock=False)
        problems += torn_files(cwd, killed=True)
    return Trial(f"{name}, killed", problems + bench.goes_on(words, cwd), bench.shell(words))


def killed(bench, words, cwd, rng, by_clock):
    """Kills the program at a call on a file of its results, or after a part of the time that it takes."""
    if by_clock:
        bench.reference([word for word in words if word != "--resume"])
        process = bench.start(words, cwd)
        time.sleep(rng.uniform(0.02, 1.0))
        process.kill()
        ended(process)
        return
    n = bench.count(words, SHIM, "KLUFT_CALL_COUNT", KLUFT_CALL="any", KLUFT_CALL_BELOW="{cwd}/out")
    bench.call(words, cwd, env={"LD_PRELOAD": bench.library(SHIM), "KLUFT_CALL": "any", "KLUFT_CALL_BELOW": cwd / "out",
                                "KLUFT_CALL_AT": rng.randint(1, max(1, n)), "KLUFT_CALL_ERRNO": 0, "KLUFT_CALL_HALF": rng.randint(0, 1)})


KINDS = {"kills": (kills, 14, None)}
