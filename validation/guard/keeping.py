"""Runs what plan.py says and keeps what came out."""

import concurrent.futures
import csv
import fnmatch
import json
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import plan
from kept import STAND_IN, keep_run, without, words_of_mode

MARK = "guard.json"  # beside the runs: which mode they are of
QUIET = {"output.pictures": False, "output.fields": False}
PATIENCE = 600  # seconds until a first state must have been saved
ATTEMPTS = 20  # to kill a run in its second stage, also on a busy machine


class BadUse(Exception):
    """What was asked for makes no sense; the text says why."""


def matches(name, patterns):
    return not patterns or any(text in name or fnmatch.fnmatchcase(name, text) for text in patterns)


def may_match(group, patterns):
    """Whether a group has runs that match: all of them, or some that are known only when it is run."""
    return matches(group, patterns) or any(text.startswith(group + "/") for text in patterns)


def words_of(overrides):
    words = []
    for key, value in overrides.items():
        words += ["--set", f"{key}={value if isinstance(value, str) else json.dumps(value)}"]
    return words


# ---- runs of the guard -------------------------------------------------------------------------------------------


def started(words):
    return subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace")


def finished(words):
    child = started(words)
    _, text = child.communicate()
    return child.returncode, text


def killed_with_a_state(words, results):
    """A run that is killed when it has saved its first state; what it wrote since then is there as well."""
    child = started(words)
    begin = time.monotonic()
    while not (results / "state.h5").exists():
        if child.poll() is not None or time.monotonic() - begin > PATIENCE:
            child.kill()
            raise BadUse(f"ended before a state was saved: {child.communicate()[1].strip()[-400:]}")
        time.sleep(0.002)
    child.kill()
    _, text = child.communicate()
    return child.returncode, text


def is_of_first_stage(results):
    """Whether the saved state is that of the end of the first stage: the second one has not come to its end."""
    with open(results / "history.csv", newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if None not in row.values()]
    return not any(int(row["stage"]) > 1 or (int(row["stage"]) == 1 and float(row["load_factor"]) >= 1) for row in rows)


def killed_after_first_stage(words, results):
    for _ in range(ATTEMPTS):
        shutil.rmtree(results, ignore_errors=True)
        done = killed_with_a_state(words, results)
        if is_of_first_stage(results):
            return done
    raise BadUse("the run could not be killed in its second stage; the machine is too busy or the stage is too short")


def run_one(run, options, scratch):
    results = Path(tempfile.mkdtemp(dir=scratch))
    overrides = {**(QUIET if run.quiet else {"output.pictures": False}), **run.overrides}
    command = ["run", str(run.scene), "-o", str(results / "out"), "--quiet", *words_of_mode(options.mode), *run.words]
    words = [*command, *words_of(overrides)]
    call = [str(options.binary), *words]
    done = [killed_after_first_stage(call, results / "out") if run.killed else finished(call)]
    if run.resume is not None:
        words += ["--resume", *words_of(run.resume)]
        done.append(finished([str(options.binary), *words]))
    keep_run(results / "out", options.directory / run.name, words, done, [(results, "RESULTS")])
    shutil.rmtree(results)
    return 1


def runs_of_study(study, options, scratch):
    """The program writes the command line of each case; it is run by the guard, not by the program."""
    place = Path(tempfile.mkdtemp(dir=scratch))
    call = [str(options.binary), "study", *study.words, "-o", str(place / "study"), "--emit", "make"]
    done = subprocess.run(call, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    listed = place / "study" / "cases.txt"
    if done.returncode != 0 or not listed.exists():
        raise BadUse(f"{study.name}: the program does not say what its cases are: {done.stderr.strip()[-400:]}")
    runs = []
    for line in listed.read_text(encoding="utf-8").splitlines():
        words = shlex.split(line)
        if words[1:2] != ["run"]:
            raise BadUse(f"{study.name}: expected a run of the program, found '{line[:200]}'")
        name = Path(words[words.index("-o") + 1]).name
        if any(text in name for text in study.leave_out):
            continue
        words_left = [word for word in without(without(words[3:], "-o"), "--threads") if word != "--quiet"]
        runs.append(plan.Run(f"{study.name}/{name}", Path(words[2]), words=tuple(words_left)))
    return runs


# ---- scripts that run the program --------------------------------------------------------------------------------


def run_script(script, options, scratch):
    """Runs the script with a stand-in for the program."""
    place = Path(tempfile.mkdtemp(dir=scratch))
    output = place / "out"
    settings = {"name": script.name, "binary": str(options.binary), "directory": str(options.directory), "output": str(output),
                "mode": options.mode}
    (place / "settings.json").write_text(json.dumps(settings), encoding="utf-8")
    program = place / "kluft"
    program.write_text("#!/bin/sh\nexec " + shlex.join([sys.executable, "-S", str(plan.HERE / "run"), STAND_IN, str(place / "settings.json")])
                       + ' "$@"\n', encoding="utf-8")
    program.chmod(0o755)
    command = [word.format(program=program, output=output) for word in script.command]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, cwd=place)
    # 1: a quantity missed its tolerance, which is not the question here; what was run is kept.
    if done.returncode not in (0, 1):
        raise BadUse(f"{script.name}: exit code {done.returncode}: {done.stdout.strip()[-600:]}")
    count = sum(1 for _ in (options.directory / script.name).rglob("run.json"))
    if count == 0:
        raise BadUse(f"{script.name}: runs nothing: {done.stdout.strip()[-600:]}")
    shutil.rmtree(place)
    return count


# ---- all together ------------------------------------------------------------------------------------------------


def chosen(options, scratch):
    tasks = []
    for task in plan.everything():
        if isinstance(task, plan.Study):
            if may_match(task.name, options.only):
                tasks += [run for run in runs_of_study(task, options, scratch) if matches(run.name, options.only)]
        elif may_match(task.name, options.only) if isinstance(task, plan.Script) else matches(task.name, options.only):
            tasks.append(task)
    return sorted(tasks, key=lambda task: not task.long)


def prepare(options):
    options.binary, options.directory = options.binary.resolve(), options.directory.resolve()
    if options.jobs < 1:
        raise BadUse("--jobs: expected at least 1")
    if not (options.binary.is_file() and os.access(options.binary, os.X_OK)):
        raise BadUse(f"{options.binary}: no such program")
    if options.directory.exists() and not (options.directory / MARK).exists() and \
            (not options.directory.is_dir() or any(options.directory.iterdir())):
        raise BadUse(f"{options.directory}: exists and is no keeping of this script")


def make_directory(options):
    if options.directory.exists():
        shutil.rmtree(options.directory)
    options.directory.mkdir(parents=True)
    (options.directory / MARK).write_text(json.dumps({"mode": options.mode, "only": options.only}) + "\n", encoding="utf-8")


def perform(task, options, scratch):
    begin = time.monotonic()
    count = run_script(task, options, scratch) if isinstance(task, plan.Script) else run_one(task, options, scratch)
    return count, time.monotonic() - begin


def keep(options):
    prepare(options)
    with tempfile.TemporaryDirectory(prefix="kluft-guard-") as scratch:
        begin = time.monotonic()
        tasks = chosen(options, scratch)
        if not tasks:
            raise BadUse(f"--only: nothing is named like {', '.join(options.only)}")
        if options.list:
            print("\n".join(task.name + ("/..." if isinstance(task, plan.Script) else "") for task in tasks))
            return 0
        make_directory(options)
        n_runs, failures = 0, []
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            futures = {pool.submit(perform, task, options, scratch): task for task in tasks}
            for future in concurrent.futures.as_completed(futures):
                name = futures[future].name
                try:
                    count, seconds = future.result()
                except (BadUse, OSError) as error:
                    failures.append(name)
                    print(f"{name}: {error}", file=sys.stderr, flush=True)
                    continue
                n_runs += count
                print(f"{name}: {count} {'run' if count == 1 else 'runs'}, {seconds:.1f} s", flush=True)
    print(f"\n{n_runs} runs kept in {options.directory}, {time.monotonic() - begin:.0f} s" + (f"; {len(failures)} could not be run" if failures else ""))
    return 2 if failures else 0
