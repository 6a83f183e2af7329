"""Signals in the midst of runs, studies and calibrations; several processes in one directory."""

import re
import signal
import time

from bench import BAD_INPUT, DONE, Trial, differences, disagreement, ended, torn_files, wait_for_rows

SIGNALS = ["SIGHUP", "SIGINT", "SIGTERM", "SIGPIPE", "SIGQUIT", "SIGXCPU", "SIGXFSZ", "SIGUSR1"]
IGNORED = {"SIGPIPE", "SIGXFSZ"}  # the call that they are about fails instead


def signals(bench, i):
    which, name = SIGNALS[i % 8], ["run", "run", "study", "slope", "run", "explicit", "calibration"][i // 8 % 7]
    words, rng, cwd = bench.jobs()[name], bench.rng("signals", i), bench.place("signals", i)
    process = bench.start(words, cwd)
    if words[0] == "run":
        wait_for_rows(cwd / "out", rng.randint(0, {"run": 24, "slope": 8, "explicit": 4}[name]), process)
        time.sleep(rng.uniform(0.0, 0.05))
    else:
        time.sleep(rng.uniform(0.2, 1.5))
    process.send_signal(getattr(signal, which))
    end = ended(process)
    expected = DONE if which in IGNORED else 128 + getattr(signal, which)
    problems = end.crash()
    if end.code not in (expected, DONE) and not problems:
        problems.append(f"exit {end.code} instead of {expected}: {end.said()}")
    if words[0] == "run":
        problems += disagreement(end.code, cwd / "out")
        problems += [] if (cwd / "out/state.h5").exists() else ["no state"]
    problems += torn_files(cwd) + bench.goes_on(words, cwd)
    return Trial(f"{which}, {name}, exit {end.code}", problems, f"{bench.shell(words)} & sleep 0.3; kill -{which[3:]} $!; wait $!; echo $?")


def together(bench, i):
    """The second process says whose directory it is, or comes after the first one's end: then the same scene is run anew and another
    one is refused, as its results would be lost. The results are of one of them."""
    kinds = [("run", "run"), ("run", "other run"), ("run", "resume"), ("study", "study"), ("study", "run"), ("calibration", "calibration")]
    first, second = kinds[i % len(kinds)]
    jobs = bench.jobs()
    jobs["other run"] = [*jobs["run"], "--set", "stages.1.steps=16"]
    jobs["resume"] = [*jobs["run"], "--resume"]
    rng, cwd = bench.rng("together", i), bench.place("together", i)
    process = bench.start(jobs[first], cwd)
    if second == "resume":
        wait_for_rows(cwd / "out", rng.randint(6, 20), process)
    else:
        time.sleep(rng.choice([0.0, 0.005, 0.02, 0.05, 0.1, 0.2]))
    ends = [bench.call(jobs[second], cwd)]
    ends.insert(0, ended(process))
    problems = [crash for end in ends for crash in end.crash()]
    refused = [end for end in ends if end.code == BAD_INPUT]
    if not problems and (any(end.code not in (DONE, BAD_INPUT) for end in ends) or len(refused) > 1):
        problems.append("; ".join(end.said() for end in ends if end.code != DONE))
    named = r"process \d+|results of another one.*--force.*--resume" if second == "other run" else r"process \d+"
    problems += [f"neither the other process nor the other scene is named: {end.said()}" for end in refused if not re.search(named, end.err)]
    winners = [words for words, end in zip((first, second), ends) if end.code == DONE]
    if winners and all(differences(cwd / "out", bench.reference(plain(jobs[w])), jobs[w]) for w in winners):
        problems.append("tables of neither")
    codes = ", ".join(str(end.code) for end in ends)
    return Trial(f"{first} and {second}, exits {codes}", problems + torn_files(cwd), f"{bench.shell(jobs[first])} & {bench.shell(jobs[second])}")


def plain(words):
    return [word for word in words if word != "--resume"]


KINDS = {"signals": (signals, 2, None), "several processes in one directory": (together, 2, None)}
