"""Disturbs the built programs in many ways and counts what they do not survive."""

import argparse
import concurrent.futures
import itertools
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parent))

import damage  # noqa: E402
import faults  # noqa: E402
import hard  # noqa: E402
import kills  # noqa: E402
import limits  # noqa: E402
import mutations  # noqa: E402
import repeats  # noqa: E402
import report  # noqa: E402
import signals  # noqa: E402
from bench import ROOT, TIME_LIMIT, Bench, Trial  # noqa: E402

# Name -> (trial of a number, share of the time, how many there are or None).
KINDS = {name: kind for module in (kills, faults, limits, signals, damage, mutations, hard, repeats) for name, kind in module.KINDS.items()}
MINUTES, SHORT_MINUTES = 60.0, 1.0
EPILOG = """Trial number i of a kind is the same for the same --seed; how many there are depends on the time. Kinds with a fixed number of
trials are done completely, except with --short. Exit code 1 where a trial failed; its directory is kept in DIR/work/trials.

kinds: """ + ", ".join(KINDS) + """

examples:
  scripts/campaign                                 an hour on two cores
  scripts/campaign --short                         one minute
  scripts/campaign --kind kills --minutes 5
  scripts/campaign --kind signals --trial 17       one trial again
"""


def arguments_of_program():
    parser = argparse.ArgumentParser(prog="scripts/campaign", description=__doc__, epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kluft", type=Path, default=ROOT / "build/release/kluft", metavar="FILE",
                        help="the program, beside which kluft-calibrate stands (default: build/release/kluft of this repository)")
    parser.add_argument("--minutes", type=float, metavar="N", help=f"of all kinds together (default: {MINUTES:g})")
    parser.add_argument("--short", action="store_true", help=f"{SHORT_MINUTES:g} minute, some trials of each kind")
    parser.add_argument("--kind", action="append", default=[], metavar="NAME", choices=list(KINDS), help="only this kind; may be given several times")
    parser.add_argument("--trial", type=int, metavar="I", help="only this trial")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of all random choices (default: 1)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="trials at a time (default: one per core)")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "results/campaign", metavar="DIR", help="directory of the table and of what failed")
    parser.add_argument("--docs", action="store_true", help="write docs/reliability.md too")
    options = parser.parse_args()
    if not options.kluft.is_file():
        parser.error(f"{options.kluft}: no such program; build it with scripts/build, or name it with --kluft")
    if options.trial is not None and len(options.kind) != 1:
        parser.error("--trial: needs one --kind")
    options.minutes = options.minutes or (SHORT_MINUTES if options.short else MINUTES)
    return options


def new_bench(options):
    """A place to work in, with copies of the programs, so that a build meanwhile changes nothing."""
    work = options.output / "work"
    shutil.rmtree(work, ignore_errors=True)
    (work / "bin").mkdir(parents=True)
    for name in ("kluft", "kluft-calibrate"):
        if (options.kluft.parent / name).exists():
            shutil.copy2(options.kluft.parent / name, work / "bin" / name)
    return Bench(work / "bin/kluft", work, options.seed, options.short)


def done(bench, kind, i):
    """Trial i, or None where there is none of this number."""
    try:
        trial = KINDS[kind][0](bench, i)
    except Exception as error:  # of the campaign itself: counts as a failure, too
        trial = Trial("no trial", [f"{type(error).__name__}: {error}"])
    if trial is None or not trial.problems:
        shutil.rmtree(bench.work / "trials" / f"{KINDS[kind][0].__name__}-{i}", ignore_errors=True)
    return trial


def trials_of(bench, kind, options, seconds):
    """Trials 0, 1, ... until the time is over or there are no more."""
    if options.trial is not None:
        return {options.trial: done(bench, kind, options.trial)}
    count, end = KINDS[kind][2], time.monotonic() + seconds
    complete = count is not None and not options.short
    numbers, results = iter(range(count) if count else itertools.count()), {}

    def work():
        while complete or time.monotonic() < end:
            i = next(numbers, None)
            if i is None:
                return
            trial = done(bench, kind, i)
            if trial is not None:
                results[i] = trial
                if trial.problems:
                    print(f"  FAILED trial {i}: {trial.outcome}: {'; '.join(trial.problems)[:200]}", flush=True)

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for worker in [pool.submit(work) for _ in range(options.jobs)]:
            worker.result()
    return results


def version(bench):
    return subprocess.run([bench.kluft, "--version"], capture_output=True, text=True).stdout.strip()


def main():
    options = arguments_of_program()
    bench, begin, results = new_bench(options), time.monotonic(), {}
    tested = version(bench)
    kinds = options.kind or list(KINDS)
    shares = sum(KINDS[kind][1] for kind in kinds)
    for kind in kinds:
        start = time.monotonic()
        left = options.minutes * 60 - (start - begin)  # the references of the first kinds take time from all
        trials = trials_of(bench, kind, options, max(1.0, left * KINDS[kind][1] / shares))
        shares -= KINDS[kind][1]
        results[kind] = trials, time.monotonic() - start
        failed = sum(bool(t.problems) for t in trials.values())
        print(f"{kind:40} {len(trials):6} trials {failed:4} failures {time.monotonic() - start:7.0f} s", flush=True)
    minutes = (time.monotonic() - begin) / 60
    about = f"{tested}, {os.cpu_count()} cores, {minutes:.0f} minutes, seed {options.seed}."
    text = report.text_of(results, about, ROOT / "results", TIME_LIMIT)
    (options.output / "reliability.md").write_text(text)
    if options.docs:
        (ROOT / "docs/reliability.md").write_text(text)
    n_failed = sum(bool(t.problems) for trials, _ in results.values() for t in trials.values())
    print(f"{sum(len(trials) for trials, _ in results.values())} trials, {n_failed} failures, {minutes:.1f} minutes; {options.output / 'reliability.md'}")
    return 1 if n_failed else 0


if __name__ == "__main__":
    sys.exit(main())
