"""One run of the program under a bound of time, and what became of it."""

import json
import math
import os
import re
import resource
import signal
import subprocess
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from suite.fields import Fields  # noqa: E402

from kluft.tables import read_table  # noqa: E402

DONE, BAD_INPUT, NO_EQUILIBRIUM = 0, 2, 3
NOT_A_NUMBER = re.compile(r"(?<![a-z])[-+]?(nan|inf|infinity)(?![a-z])", re.IGNORECASE)
MEMORY = 12 << 30  # bytes of address space of one run


@dataclass
class Outcome:
    """Of one run. `exit_code` is None where the bound of time was reached."""

    directory: Path
    exit_code: int | None
    text: str
    seconds: float
    summary: dict = field(default_factory=dict)
    history: dict = field(default_factory=dict)  # column -> array

    @property
    def last(self):
        return {name: column[-1] for name, column in self.history.items()}

    @property
    def n_steps(self):
        return len(self.history["step"]) - 1

    @property
    def balanced(self):
        return bool(np.all(self.history["balanced"] == 1))

    @property
    def done(self):
        return self.exit_code == DONE and self.summary.get("status") == "done"

    @property
    def equilibria(self):
        return read_columns(self.directory / "equilibria.csv")

    @property
    def cracks(self):
        return read_columns(self.directory / "cracks.csv", ("mode",))

    @property
    def histories(self):
        return read_columns(self.directory / "histories.csv")

    def blocks(self):
        return Fields(max((self.directory / "fields").glob("blocks_*.vtu")))

    def message(self):
        """The line that says why."""
        lines = [line.strip() for line in self.text.splitlines() if line.strip() and not line.startswith("      ")]
        lines = [line for line in lines if "warning" not in line] or lines
        return re.sub(r"\S*scene\.yaml", "scene.yaml", lines[0]) if lines else ""


def has_no_number(path):
    """Whether a table or a field file holds something that is no finite number."""
    if path.suffix in (".csv", ".json", ".log"):
        return bool(NOT_A_NUMBER.search(path.read_text(encoding="utf-8")))
    if path.suffix == ".vtu":
        content = Fields(path)
        arrays = [content.points, content.displacement, *content.field.values()]
        return not all(np.all(np.isfinite(array)) for array in arrays)
    return False


def run(kluft, scene, directory, limit):
    directory.mkdir(parents=True, exist_ok=True)
    for stale in directory.rglob("*.*"):
        if stale.is_file():
            stale.unlink()
    (directory / "scene.yaml").write_text(json.dumps(scene), encoding="utf-8")
    command = [str(kluft), "run", str(directory / "scene.yaml"), "-o", str(directory), "--quiet", "--threads", "1"]
    output = directory / "output.txt"
    with open(output, "w", encoding="utf-8") as sink:
        child = subprocess.Popen(command, stdout=sink, stderr=subprocess.STDOUT, start_new_session=True,
                                 preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (int(limit) + 1, int(limit) + 2)))
        try:
            exit_code = child.wait(10 * limit + 60)  # the bound is one of CPU time; a busy machine is not the program's fault
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            child.wait()
            exit_code = None
    if exit_code in (-signal.SIGXCPU, -signal.SIGKILL):
        exit_code = None
    outcome = Outcome(directory, exit_code, output.read_text(encoding="utf-8", errors="replace"), limit)
    read_tables(outcome)
    return outcome


def read_columns(path, texts=()):
    """A table by columns, as numbers but for those named in `texts`."""
    table = read_table(path)
    return {name: table[name].astype(float) for name in table.dtype.names if name not in texts}


def read_tables(outcome):
    try:
        outcome.summary = json.loads((outcome.directory / "summary.json").read_text(encoding="utf-8"))
        outcome.seconds = outcome.summary["elapsed_s"]
        outcome.history = read_columns(outcome.directory / "history.csv")
    except (OSError, ValueError, KeyError):
        pass


@dataclass
class Check:
    """A number that was found against the one expected."""

    name: str
    expected: float
    found: float
    tolerance: float

    @property
    def error(self):
        if not (math.isfinite(self.expected) and math.isfinite(self.found)):
            return math.inf
        return abs(self.found - self.expected) / abs(self.expected) if self.expected != 0 else abs(self.found)

    @property
    def met(self):
        return self.error <= self.tolerance


@dataclass
class Verdict:
    """kind: right, refused, stopped, unbalanced, WRONG, NAN, CRASH or TIMEOUT (capitals: a failure)."""

    kind: str
    remark: str
    seconds: float = 0.0
    error: float | None = None


def verdict_of(point, outcomes):
    seconds = sum(outcome.seconds for outcome in outcomes)
    kind, remark, error = kind_of(point, outcomes)
    return Verdict(kind, remark, seconds, error)


def kind_of(point, outcomes):
    for outcome in outcomes:
        if outcome.exit_code is None:
            return "TIMEOUT", f"no end within {point.limit:g} s of CPU time", None
        if outcome.exit_code not in (DONE, BAD_INPUT, NO_EQUILIBRIUM):
            return "CRASH", f"exit code {outcome.exit_code}: {outcome.message()}", None
        spoilt = [path.name for path in sorted(outcome.directory.rglob("*.*")) if has_no_number(path)]
        if spoilt:
            return "NAN", ", ".join(spoilt[:3]), None
    for outcome in outcomes:
        if outcome.exit_code != DONE and not outcome.message():
            return "CRASH", f"exit code {outcome.exit_code} without a word", None
        if outcome.exit_code == BAD_INPUT:
            return "refused", outcome.message(), None
    for outcome, may_fall in zip(outcomes, point.may_fall or [False] * len(outcomes)):
        if not may_fall and not outcome.done:
            return "stopped", outcome.message() or outcome.summary.get("message", ""), None
    if point.no_equilibrium:
        return ("unbalanced", "said so in each row", None) if not outcomes[0].balanced else ("WRONG", "an equilibrium that does not exist", None)
    checks = point.judge(outcomes)
    worst = max(checks, key=lambda check: check.error / check.tolerance)
    if worst.met:
        return "right", f"{worst.name}: error {worst.error:.1e}, tolerance {worst.tolerance:.0e}", worst.error
    remark = f"{worst.name}: expected {worst.expected:.10g}, found {worst.found:.10g}, tolerance {worst.tolerance:.0e}"
    said = any(not outcome.balanced for outcome, may_fall in zip(outcomes, point.may_fall or [False] * len(outcomes)) if not may_fall)
    return ("unbalanced" if said else "WRONG"), remark, worst.error
