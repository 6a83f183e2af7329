"""What is kept of one run; and the stand-in for the program, which keeps each run of a script."""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
STAND_IN = "--stand-in"
TABLES = ("history.csv", "equilibria.csv", "cracks.csv", "histories.csv", "summary.json")
TIME_OF_LOG = re.compile(r"^\S+ \S+ ")
SECONDS_OF_LOG = re.compile(r", [0-9.]+ s; results in \S+")


def words_of_mode(mode):
    return ["--set", "solver.repeatable=true"] if mode == "repeatable" else ["--threads", "1"]


def without(words, option):
    """Without an option and its value."""
    words = list(words)
    while option in words:
        at = words.index(option)
        del words[at:at + 2]
    return words


def plain(text, places):
    """Without the names of directories."""
    for place, name in [*places, (str(ROOT), "PROJECT")]:
        text = text.replace(str(place), name)
    return text


def log_lines(path, places):
    """The log without times."""
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines() if path.exists() else []
    return "".join(plain(SECONDS_OF_LOG.sub("", TIME_OF_LOG.sub("", line)), places) + "\n" for line in lines)


def keep_run(results, target, words, done, places):
    """`results`: where the program wrote; `words`: of its command line; `done`: exit code and text of each process."""
    target.mkdir(parents=True)
    for name in TABLES:
        if (results / name).exists():
            shutil.copyfile(results / name, target / name)
    fields = sorted(file for kind in ("fields/*.vtu", "contacts/*.csv", "supports/*.csv") for file in results.glob(kind))
    if fields:
        sums = "".join(f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.relative_to(results)}\n" for file in fields)
        (target / "fields.txt").write_text(sums, encoding="utf-8")
    (target / "log.txt").write_text(log_lines(results / "run.log", places), encoding="utf-8")
    (target / "stderr.txt").write_text(plain("".join(text for _, text in done), places), encoding="utf-8")
    facts = {"arguments": [plain(word, places) for word in words], "exit_codes": [code for code, _ in done]}
    (target / "run.json").write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")


# ---- the stand-in ------------------------------------------------------------------------------------------------


def free_name(directory, name):
    """A name that is not taken: a script may run something twice under one name."""
    number, target = 1, directory / name
    while target.exists():
        number += 1
        target = directory / f"{name}~{number}"
    return target


def stand_in(settings_file, words):
    """Called by scripts instead of the program: runs it with the options of the mode, and keeps its results."""
    settings = json.loads(Path(settings_file).read_text(encoding="utf-8"))
    binary = settings["binary"]
    if words[:1] != ["run"] or "-o" not in words:
        os.execv(binary, [binary, *words])
    results, output = Path(words[words.index("-o") + 1]).resolve(), Path(settings["output"]).resolve()
    words = [*without(words, "--threads"), *words_of_mode(settings["mode"])]
    done = subprocess.run([binary, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace", check=False)
    name = str(results.relative_to(output)) if results.is_relative_to(output) else results.name
    target = free_name(Path(settings["directory"]), f"{settings['name']}/{name}")
    keep_run(results, target, words, [(done.returncode, done.stderr)], [(output, "RESULTS")])
    sys.stdout.write(done.stdout)
    sys.stderr.write(done.stderr)
    return done.returncode if done.returncode >= 0 else 128 - done.returncode
