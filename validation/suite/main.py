"""Runs cases of the validation suite: scripts/validate."""

import argparse
import concurrent.futures
import contextlib
import difflib
import errno
import importlib.util
import json
import multiprocessing
import os
import shutil
import signal
import sys
import traceback
from pathlib import Path

CASES = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(CASES))
STOPPING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
OUT_OF_DISK = (errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO)
EPILOG = """Results of case C go to DIR/C. A run of the whole suite also writes report.md, report.html and the figures into the
directory of the cases and the tables into their READMEs; a run of some cases writes its report into DIR only.
Exit codes: 0 all within tolerance, 1 a miss, 2 an unknown case, no program or no place for the results, 4 out of disk,
128 + n stopped by signal n (130: Ctrl-C).

examples:
  kluft validate
  kluft validate incline overturning -o results/today
  kluft validate --list
"""


def case_names():
    return sorted(check.parent.name for check in CASES.glob("*/check.py"))


def arguments(words):
    parser = argparse.ArgumentParser(prog="kluft validate", description=__doc__, epilog=EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", metavar="CASE", help="cases to run (default: all)")
    parser.add_argument("-o", "--output", type=Path, default=Path("results/validation"), metavar="DIR",
                        help="directory of all results (default: results/validation)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N",
                        help="cases at a time (default: the number of processors)")
    parser.add_argument("--kluft", type=Path, default=CASES.parent / "build" / "release" / "kluft", metavar="FILE",
                        help="the program (default: build/release/kluft)")
    parser.add_argument("--list", action="store_true", help="name the cases and run nothing")
    return parser.parse_args(words)


def refuse(message):
    print(f"validate: {message}", file=sys.stderr)
    return 2


def unknown_case(chosen, names):
    for name in chosen:
        if name not in names:
            near = difflib.get_close_matches(name, names, 1, 0.4)
            return f"unknown case '{name}'" + (f"; did you mean '{near[0]}'?" if near else "") + \
                f"\nexpected some of {', '.join(names)}"
    return None


def title_of(name):
    from suite import report

    readme = CASES / name / "README.md"
    return (report.title_of(readme.read_text(encoding="utf-8")) if readme.exists() else "") or name


def note_failure(case, error):
    """Writes what broke and makes it a miss of the case; in one line."""
    from suite.case import Row

    failure = f"{type(error).__name__}: {error}"
    (case.output / "failure.txt").write_text(traceback.format_exc(), encoding="utf-8")
    case.rows.append(Row(case.name, "check", "a result", failure.splitlines()[0][:90], None, None, "same", False))
    return failure


def run_case(name, output, program):
    """The outcome of one case as plain values, for another process to read."""
    from suite.case import Case

    case = Case(name, CASES / name, output / name, program)
    case.output.mkdir(parents=True, exist_ok=True)
    for stale in ("figure.png", "failure.txt"):
        (case.output / stale).unlink(missing_ok=True)
    failure = ""
    try:
        spec = importlib.util.spec_from_file_location(f"check_{name.replace('-', '_')}", CASES / name / "check.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        module.check(case)
    except OSError as error:
        if error.errno in OUT_OF_DISK:
            raise
        failure = note_failure(case, error)
    except Exception as error:  # a case that breaks is a miss and must not keep the others from running
        failure = note_failure(case, error)
    for row in case.rows:
        row.seconds = case.seconds
    return {"case": name, "title": title_of(name), "rows": [row.as_dict() for row in case.rows], "failure": failure,
            "seconds": case.seconds, "figure": (case.output / "figure.png").exists()}


def lead_own_group():
    """A process that runs cases, and the program in it, are stopped by stop_all alone."""
    os.setpgid(0, 0)
    for number in STOPPING:
        signal.signal(number, signal.SIG_DFL)


def stop_all(number, _frame):
    for worker in multiprocessing.active_children():
        for end in (os.killpg, os.kill):
            with contextlib.suppress(OSError):
                end(worker.pid, signal.SIGTERM)
    print(f"validate: stopped by {signal.Signals(number).name}", file=sys.stderr, flush=True)
    os._exit(128 + number)  # without waiting for the cases that have not begun


def run_cases(names, options):
    outcomes = {}
    with concurrent.futures.ProcessPoolExecutor(options.jobs, initializer=lead_own_group) as pool:
        for number in STOPPING:
            signal.signal(number, stop_all)
        futures = {pool.submit(run_case, name, options.output, options.kluft): name for name in names}
        for done in concurrent.futures.as_completed(futures):
            outcome = done.result()
            outcomes[outcome["case"]] = outcome
            missed = sum(not row["met"] for row in outcome["rows"])
            verdict = f"{missed} missed" if missed else "within tolerance"
            print(f"{outcome['case']}: {verdict}, {outcome['seconds']:.1f} s", file=sys.stderr, flush=True)
    return [outcomes[name] for name in names]


def write_reports(outcomes, options, whole):
    from suite import report

    places = [options.output] + ([CASES] if whole and os.access(CASES, os.W_OK) else [])
    for place in places:
        for outcome in outcomes:
            figure = options.output / outcome["case"] / "figure.png"
            if place != options.output and figure.exists():
                shutil.copyfile(figure, place / outcome["case"] / "figure.png")
            if place == CASES:
                report.update_readme(CASES / outcome["case"] / "README.md", outcome["rows"])
        report.write_markdown(place / "report.md", outcomes)
        report.write_html(place / "report.html", outcomes)
    (options.output / "report.json").write_text(json.dumps(outcomes, indent=1), encoding="utf-8")
    return places[-1] / "report.html"


def main(words):
    options = arguments(words)
    names = case_names()
    message = unknown_case(options.cases, names)
    if message:
        return refuse(message)
    if options.jobs < 1:
        return refuse("--jobs: expected at least 1")
    chosen = [name for name in names if name in options.cases] if options.cases else names
    if options.list:
        for name in chosen:
            print(f"{name:24} {title_of(name)}")
        return 0
    for module in ("numpy", "matplotlib", "scipy"):
        if importlib.util.find_spec(module) is None:
            return refuse(f"the Python module {module} is missing: install python3-{module} (scripts/install-packages)")
    if not options.kluft.is_file() or not os.access(options.kluft, os.X_OK):
        return refuse(f"{options.kluft}: no such program; build it with scripts/build, or name it with --kluft")
    options.kluft = options.kluft.resolve()
    options.output = options.output.resolve()
    try:
        options.output.mkdir(parents=True, exist_ok=True)
        return run_and_report(chosen, options, chosen == names)
    except OSError as error:
        refuse(f"{error.filename or options.output}: {error.strerror}")
        return 4 if error.errno in OUT_OF_DISK else 2


def run_and_report(chosen, options, whole):
    from suite import report

    outcomes = run_cases(chosen, options)
    rows = [row for outcome in outcomes for row in outcome["rows"]]
    print(report.text_table(rows))
    written = write_reports(outcomes, options, whole)
    print(f"\n{report.closing_line(outcomes)}\n{written}")
    return 0 if all(row["met"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
