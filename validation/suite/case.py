"""What a check.py works with: runs of the program, expected against found values, a figure."""

import errno
import json
import math
import shutil
import subprocess
import time
from dataclasses import asdict, dataclass

import numpy as np
import yaml

from suite import figures
from suite.fields import Fields

from kluft.tables import read_table as Table

NO_EQUILIBRIUM = 3
OUT_OF_RESOURCES = 4
DEFAULT_TOLERANCE = 5e-3  # of rows with the program's defaults
NUMERICAL_KEYS = ("contact_rounding", "friction_rounding", "cohesion_onset")  # of interfaces


class RunFailed(Exception):
    """The program refused a scene or left no result."""


@dataclass
class Row:
    """One line of the table. Numbers are texts already; `error` and `tolerance` stay numbers, None for texts compared."""

    case: str
    quantity: str
    expected: str
    found: str
    error: float | None
    tolerance: float | None
    kind: str  # "relative", "absolute" or "same"
    met: bool
    seconds: float = 0.0

    def as_dict(self):
        return asdict(self)


class Run:
    """The results of one run."""

    def __init__(self, directory, exit_code, output):
        self.directory = directory
        self.exit_code = exit_code
        self.output = output
        self.summary = json.loads((directory / "summary.json").read_text(encoding="utf-8"))
        self.history = Table(directory / "history.csv")

    @property
    def balanced(self):
        """Whether every load step ended in equilibrium."""
        return self.exit_code == 0 and bool(np.all(self.history["balanced"] == 1))

    @property
    def equilibria(self):
        return Table(self.directory / "equilibria.csv")

    @property
    def cracks(self):
        return Table(self.directory / "cracks.csv")

    @property
    def histories(self):
        return Table(self.directory / "histories.csv")

    @property
    def field_steps(self):
        return sorted(int(file.stem.split("_")[1]) for file in (self.directory / "fields").glob("blocks_*.vtu"))

    def blocks(self, step=None):
        return self._fields("blocks", step)

    def interfaces(self, step=None):
        return self._fields("interfaces", step)

    def _fields(self, part, step):
        step = self.field_steps[-1] if step is None else step
        return Fields(self.directory / "fields" / f"{part}_{step:06}.vtu")


def overrides_of(values):
    """{"stages.1.steps": 20} as the words of the command line. A value may be a number, a text, a list or a mapping."""
    words = []
    for key, value in values.items():
        words += ["--set", f"{key}={value if isinstance(value, str) else json.dumps(value)}"]
    return words


def with_defaults(scene, target):
    """A copy of the scene without any numerical setting: no `solver`, of `cracks` the criterion alone, no roundings."""
    content = yaml.safe_load(scene.read_text(encoding="utf-8"))
    content.pop("solver", None)
    criterion = content.pop("cracks", {}).get("criterion")
    if criterion:
        content["cracks"] = {"criterion": criterion}
    for interface in content["interfaces"].values():
        for key in NUMERICAL_KEYS:
            interface.pop(key, None)
    copy = target / scene.name
    copy.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")
    return copy


class Case:
    """One case at work: collects its rows and makes its figure."""

    def __init__(self, name, directory, output, program):
        self.name = name
        self.directory = directory  # of README.md, scene.yaml, check.py
        self.output = output  # of its runs
        self.program = program
        self.rows = []
        self.seconds = 0.0  # in the program

    def run(self, name, overrides=None, scene="scene.yaml", may_fail=False, defaults=False):
        """Runs a scene with overrides. Without `may_fail` a run that finds no equilibrium ends the check. `defaults`: with
        the program's defaults in place of all numerical settings of the scene."""
        target = self.output / (f"defaults-{name}" if defaults else name)
        shutil.rmtree(target, ignore_errors=True)  # results of an earlier version of the case
        target.mkdir(parents=True)
        path = with_defaults(self.directory / scene, self.output) if defaults else self.directory / scene
        command = [str(self.program), "run", str(path), "-o", str(target), "--quiet"]
        command += overrides_of({"output.pictures": False, "output.report": False, **(overrides or {})})
        start = time.monotonic()
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        self.seconds += time.monotonic() - start
        (target / "output.txt").write_text(done.stdout, encoding="utf-8")
        if done.returncode == OUT_OF_RESOURCES:
            raise OSError(errno.ENOSPC, done.stdout.strip()[-600:], str(target))
        allowed = (0, NO_EQUILIBRIUM) if may_fail else (0,)
        if done.returncode not in allowed or not (target / "summary.json").exists():
            raise RunFailed(f"{name}: exit code {done.returncode}: {done.stdout.strip()[-600:]}")
        return Run(target, done.returncode, done.stdout)

    def expect(self, quantity, expected, found, tolerance, unit="", absolute=False, digits=7):
        """A row for a number. The error is relative, or absolute in units of the number; returns whether it is met."""
        difference = abs(found - expected)
        error = difference if absolute else difference / abs(expected) if expected != 0.0 else math.inf
        error = math.inf if math.isnan(error) else float(error)
        suffix = f" {unit}" if unit else ""
        self.rows.append(Row(self.name, quantity, f"{expected:.{digits}g}{suffix}", f"{found:.{digits}g}{suffix}", error,
                             tolerance, "absolute" if absolute else "relative", bool(error <= tolerance)))
        return self.rows[-1].met

    def expect_worst(self, quantity, expected, found, tolerance, unit="", absolute=False, digits=7):
        """One row for many numbers: that of the largest error."""
        expected, found = np.broadcast_arrays(np.asarray(expected, float), np.asarray(found, float))
        errors = np.abs(found - expected) / (1.0 if absolute else np.abs(expected))
        worst = int(np.argmax(np.where(np.isnan(errors), np.inf, errors)))
        return self.expect(f"{quantity} (worst of {expected.size})", float(expected.flat[worst]),
                           float(found.flat[worst]), tolerance, unit, absolute, digits)

    def expect_default(self, quantity, expected, found, unit="", digits=5):
        """A row for the worst of one or many numbers that were found with the program's defaults."""
        name = f"{quantity}, defaults"
        if np.size(found) == 1:
            return self.expect(name, float(np.ravel(expected)[0]), float(np.ravel(found)[0]), DEFAULT_TOLERANCE, unit, digits=digits)
        return self.expect_worst(name, expected, found, DEFAULT_TOLERANCE, unit, digits=digits)

    def expect_same(self, quantity, expected, found):
        """A row for texts or counts that have to be the same."""
        self.rows.append(Row(self.name, quantity, str(expected), str(found), None, None, "same", expected == found))
        return self.rows[-1].met

    def figure(self, width=8.4, height=3.4, sketch=True, **options):
        """A figure in the house style with a panel for the sketch and one for the result; `save_figure` keeps it."""
        return figures.panels(width, height, sketch, **options)

    def save_figure(self, figure):
        figures.save(figure, self.output / "figure.png")


def bisect(holds, low, high, width):
    """The limit between `low`, where `holds` is true, and `high`, where it is not, to within `width`: (low, high)."""
    while high - low > width:
        middle = 0.5 * (low + high)
        if holds(middle):
            low = middle
        else:
            high = middle
    return low, high


def order_of_convergence(sizes, errors):
    """Slope of log(error) on log(size) by least squares."""
    return float(np.polyfit(np.log(sizes), np.log(np.abs(errors)), 1)[0])

