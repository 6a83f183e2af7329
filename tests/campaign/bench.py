"""What all kinds of trials share: scenes, processes that are disturbed, and a look at what they leave."""

import csv
import io
import json
import os
import random
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.append(str(ROOT / "validation/suite"))
from fields import data_arrays  # noqa: E402

DONE, MISSED, BAD_INPUT, NO_EQUILIBRIUM, NO_RESOURCES = range(5)
TIME_LIMIT = 120.0  # s of a process; it hangs after that
TABLES = ["history.csv", "equilibria.csv", "cracks.csv", "jumps.csv", "histories.csv"]
FOLDERS_OF_TABLES = {"contacts", "supports"}  # one table per kept state, written at once
COLUMNS_OF_TIME = {"elapsed_s"}
STATUS = {0: {"done", "collapsed"}, 3: {"no_equilibrium", "unbalanced"}, 4: {"out_of_resources", None}}
NOT_A_NUMBER = re.compile(r"(?<![A-Za-z_])[-+]?(nan|inf|infinity)(?![A-Za-z_])", re.IGNORECASE)
QUIET = {"pictures": False, "fields": False}

STUDY = """title: two cases
scene: quick.yaml
set: {output.pictures: false, output.report: false, output.fields: false}
vary: {stages.1.steps: [8, 12]}
quantities: [peak_stress]
"""
CALIBRATION = """kluft_calibration: 1
scene: intact.yaml
parameters:
  kn: {keys: [interfaces.bond.normal_stiffness], start: 300 GPa/m, from: 100 GPa/m, to: 1 TPa/m}
  c: {keys: [materials.rock.cohesion], start: 8 MPa, from: 1 MPa, to: 30 MPa}
targets:
  youngs_modulus: {value: 10 GPa, tolerance: 20 %}
  peak_stress: {value: 35 MPa, tolerance: 20 %}
evaluations: 6
"""
SLOPE = """kluft: 1
analysis: {plane: stress, gravity: [4.2, -9.06]}
materials: {rock: {density: 2500, youngs_modulus: 10 GPa, poissons_ratio: 0.2}}
interfaces: {joint: {kind: fracture, normal_stiffness: 1e10, shear_stiffness: 1e10, friction_angle: 35}}
geometry:
  domain: {rectangle: {width: 4, height: 2.5}}
  fractures: [{name: plane, trace: [[-9, 0.5], [9, 0.5]], interface: joint}, {trace: [[1.3, 0.5], [1.3, 9]], interface: joint},
              {trace: [[2.6, 0.5], [2.6, 9]], interface: joint}, {trace: [[-1, 1.5], [9, 1.5]], interface: joint}]
  reference_spacing: 1.0
boundaries: {bottom: {support: fixed}}
stages: [{name: weight, steps: 6}, {name: strength, strength_reduction: {from: 1, to: 3}}]
output: {pictures: false, fields: false}
solver: {repeatable: true}
"""


@dataclass
class Trial:
    """What became of one disturbance. `problems` is empty where the program did what it promises."""

    outcome: str
    problems: list
    command: str = ""  # what was run, for people


@dataclass
class Ended:
    code: int | str  # "hang", "killed by SIGSEGV"
    out: str = ""
    err: str = ""

    def said(self):
        lines = [line for line in self.err.strip().splitlines() if line.strip()]
        return lines[0][:160] if lines else "(no message)"

    def crash(self):
        """The problem with how it ended, if it ended as no program should."""
        return [str(self.code)] if isinstance(self.code, str) else []


class Bench:
    """The program, scenes that it runs, and the undisturbed runs that others are compared with."""

    def __init__(self, kluft, work, seed, is_short):
        self.kluft, self.work, self.seed, self.is_short = Path(kluft).resolve(), Path(work).resolve(), seed, is_short
        self.models = self.work / "models"
        self.models.mkdir(parents=True)
        self.lock = threading.RLock()
        models = ROOT / "models"
        quick = (models / "quickstart.yaml").read_text().replace("spacing: 3 cm", "spacing: 5 cm")
        quick = quick.replace("steps: 50", "steps: 24").replace("    stop_after_drop: 50 %\n", "")
        quick += "solver: {repeatable: true}\noutput: {checkpoint_every: 4, fields_every: 8, histories: {seam: {fracture: inclined}}}\n"
        intact = (models / "calibration/intact.yaml").read_text().replace("spacing: 0.5 m", "spacing: 1 m").replace("steps: 40", "steps: 10")
        intact += "solver: {repeatable: true}\n"
        files = {"quick.yaml": quick, "intact.yaml": intact, "slope.yaml": SLOPE, "study.yaml": STUDY, "target.yaml": CALIBRATION,
                 "tests.csv": "sigma_3,sigma_1\n0,10e6\n1e6,14e6\n2e6,18.5e6\n-1e6,0\n"}
        for name, text in files.items():
            (self.models / name).write_text(text)

    def rng(self, *words):
        """Random numbers that depend on the seed and the words alone."""
        return random.Random("-".join(map(str, (self.seed, *words))))

    def place(self, kind, i):
        """An empty directory of trial i; `kind` is the name of the function."""
        path = self.work / "trials" / f"{kind}-{i}"
        shutil.rmtree(path, ignore_errors=True)
        path.mkdir(parents=True)
        return path

    def model(self, name):
        return str(self.models / name)

    def run(self, scene="quick.yaml", *more):
        return ["run", self.model(scene), "-o", "out", "--quiet", *more]

    def jobs(self):
        """Every kind of work: the words of its command line."""
        return {
            "run": self.run(),
            "slope": self.run("slope.yaml"),
            "explicit": self.run("quick.yaml", "--set", "analysis.integrator=explicit", "--set", "stages.1.steps=4",
                                 "--set", "stages.1.strain.value=0.02 %"),
            "study": ["study", self.model("study.yaml"), "-o", "out", "--jobs", "1", "--quiet"],
            "calibration": ["calibrate", self.model("target.yaml"), "-o", "out", "--jobs", "1"],
            "check": ["check", self.model("quick.yaml")],
            "draw": ["draw", self.model("quick.yaml"), "-o", "scene.png"],
            "draw a run": ["draw", str(self.reference(self.run())), "-o", "run.png"],
            "draw a state": ["draw", str(self.reference(self.run())), "--step", "last", "--field", "sigma_3", "-o", "state.pdf"],
            "report": ["report", str(self.reference(self.run()))],
            "compare": ["compare", *[str(self.reference(self.run()))] * 2, "-o", "compared"],
            "envelope": ["envelope", self.model("tests.csv"), "-o", "envelope.png"],
        }

    def library(self, source):
        """A C file of the project as a library that can be preloaded."""
        with self.lock:
            library = self.work / (Path(source).stem + ".so")
            if not library.exists():
                subprocess.run(["cc", "-shared", "-fPIC", "-O1", str(ROOT / source), "-o", str(library), "-ldl"], check=True)
            return str(library)

    def start(self, words, cwd, env=None, limits=(), out=subprocess.PIPE, err=subprocess.PIPE):
        """Starts the program; `limits` are pairs of a resource and its bound, or soft and hard ones."""
        def restrict():
            for name in ("SIGXFSZ", "SIGPIPE", "SIGHUP", "SIGINT", "SIGQUIT"):
                signal.signal(getattr(signal, name), signal.SIG_DFL)
            for which, bound in [(resource.RLIMIT_CORE, 0), *limits]:
                resource.setrlimit(which, bound if isinstance(bound, tuple) else (bound, bound))
        whole = dict(os.environ, OPENBLAS_NUM_THREADS="1", **{k: str(v) for k, v in (env or {}).items()})
        return subprocess.Popen([str(self.kluft), *words], cwd=cwd, env=whole, stdin=subprocess.DEVNULL, stdout=out, stderr=err,
                                preexec_fn=restrict, start_new_session=True)

    def call(self, words, cwd, limit=TIME_LIMIT, **options):
        return ended(self.start(words, cwd, **options), limit)

    def reference(self, words):
        """The directory of results of an undisturbed run with these words, which is made where there is none."""
        with self.lock:
            cwd = self.work / "reference" / re.sub(r"[^A-Za-z0-9.=]+", "_", " ".join(w for w in words if "/" not in w))[-150:]
            cwd = cwd.with_name(cwd.name + "-" + Path(words[1]).stem)
            if not cwd.exists():
                cwd.mkdir(parents=True)
                end = self.call(words, cwd)
                if end.code not in (DONE, NO_EQUILIBRIUM):
                    raise RuntimeError(f"undisturbed run: exit {end.code}: {end.said()}")
                (cwd / "exit").write_text(str(end.code))
            return cwd / "out"

    def count(self, words, library, variable, **env):
        """How often the library saw a call in an undisturbed run: the largest number of one process."""
        with self.lock:
            key = re.sub(r"[^a-z0-9]+", "_", " ".join(map(str, (variable, words[0], Path(words[1]).stem, *words[-1:], *env.values()))))
            cwd = self.work / "counts" / key[-150:]
            if not cwd.exists():
                cwd.mkdir(parents=True)
                more = {k: str(v).replace("{cwd}", str(cwd)) for k, v in env.items()}
                self.call(words, cwd, env={"LD_PRELOAD": self.library(library), variable: cwd / "count", **more})
            counts = (cwd / "count").read_text().split() if (cwd / "count").exists() else ["0"]
            return max(map(int, counts))

    def shell(self, words, env=None):
        """The command line for people, the work directory as $W."""
        parts = [f"{k}={shlex.quote(str(v))}" for k, v in (env or {}).items()] + [shlex.join(["kluft", *words])]
        return " ".join(parts).replace(str(self.work), "$W")

    def goes_on(self, words, cwd):
        """Runs the words again, with --resume where a run left a state. What differs from the undisturbed run."""
        out = cwd / "out"
        resume = words[0] == "run" and "analysis.integrator=explicit" not in words and (out / "state.h5").exists()
        end = self.call([*words, "--resume"] if resume and "--resume" not in words else words, cwd)
        plain = [word for word in words if word != "--resume"]
        reference = self.reference(plain)
        expected = int((reference.parent / "exit").read_text())
        if end.code != expected:
            return [f"resumed: exit {end.code} instead of {expected}: {end.said()}"]
        looks = differences(out, reference, words) + torn_files(cwd, killed=words[0] != "run") + disagreement(end.code, out)
        return ["resumed: " + each for each in looks]


def ended(process, limit=TIME_LIMIT):
    try:
        out, err = process.communicate(timeout=limit)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        return Ended("hang")
    code = process.returncode
    return Ended(f"killed by {signal.Signals(-code).name}" if code < 0 else code, (out or b"").decode(errors="replace"),
                 (err or b"").decode(errors="replace"))


def wait_for_rows(out, n, process, limit=60.0):
    """Until history.csv has n rows or the process has ended."""
    end = time.monotonic() + limit
    while process.poll() is None and time.monotonic() < end:
        try:
            if (out / "history.csv").read_bytes().count(b"\n") > n:
                return
        except OSError:
            pass
        time.sleep(0.001)


def rows(path):
    if not path.exists():
        return None
    with open(path, newline="") as file:
        return [{k: v for k, v in row.items() if k not in COLUMNS_OF_TIME} for row in csv.DictReader(file)]


def differences(out, reference, words):
    """The tables that are not the reference's. A search for a strength is not repeated to the bit: there the strength is."""
    if words[0] == "run" and Path(words[1]).stem == "slope":
        found, known = (json.loads((each / "summary.json").read_text())["factor_of_safety"] for each in (out, reference))
        return [] if abs(found / known - 1) < 0.01 else [f"factor of safety {found} instead of {known}"]
    paths = {path.relative_to(each) for each in (out, reference) for path in each.rglob("*.csv") if path.name in TABLES}
    # A run that was stopped keeps the state where it was; resumed, it keeps that of the reference too.
    kept = [path.relative_to(reference) for folder in FOLDERS_OF_TABLES for path in reference.glob(f"{folder}/*.csv")]
    paths |= set(kept)
    return [f"another {path}" for path in sorted(paths) if rows(out / path) != rows(reference / path)] + other_scenes(out, reference)


def other_scenes(out, reference):
    """The scenes as run that are not the reference's. Those of a study and of a calibration name their own directories."""
    if not (reference / "history.csv").exists():
        return [f"no scene.yaml beside {path}" for path in out.rglob("history.csv") if not (path.parent / "scene.yaml").exists()]
    known, path = (reference / "scene.yaml").read_bytes(), out / "scene.yaml"
    return [] if path.exists() and path.read_bytes() == known else ["another scene.yaml"]


def status(out):
    try:
        return json.loads((out / "summary.json").read_text())["status"]
    except FileNotFoundError:
        return None
    except (ValueError, KeyError):
        return "torn"


def disagreement(code, out):
    """The exit code and the status in the summary of a run."""
    if not (out / "history.csv").exists():
        return []
    expected = STATUS.get(code, {"interrupted"} if isinstance(code, int) and code > 128 else None)
    found = status(out)
    return [f"exit {code} with status {found}"] if expected is not None and found not in expected else []


def is_whole(path):
    """Whether a file that the program writes has its end."""
    data = path.read_bytes()
    if path.suffix == ".json":
        try:
            json.loads(data)
        except ValueError:
            return False
    if path.suffix == ".png":
        return data.startswith(b"\x89PNG") and b"IEND" in data[-12:]
    if path.suffix == ".pdf":
        return data.startswith(b"%PDF") and b"%%EOF" in data[-16:]
    if path.suffix in (".svg", ".vtu", ".pvd", ".html"):
        return data.rstrip().endswith(b">")
    if path.suffix == ".yaml":  # JSON is YAML too
        return data.endswith((b"\n", b"}")) and b"\0" not in data
    return True


def is_table(path):
    return is_appended_to(path) or (path.suffix == ".csv" and path.parent.name in FOLDERS_OF_TABLES)


def is_appended_to(path):
    """Whether it is a table that grows row by row, which a kill may leave with half a row."""
    return path.name in TABLES


def is_whole_table(path):
    text = path.read_text()
    table = list(csv.reader(io.StringIO(text)))
    return not text or (text.endswith("\n") and all(len(row) == len(table[0]) for row in table))


def torn_files(cwd, killed=False):
    """Files without their end. Who was killed may leave files that are begun (*.part), which only the same run takes away, and
    half a row at the end of a table."""
    problems = []
    for path in sorted(p for p in cwd.rglob("*.*") if p.is_file()):
        if path.suffix == ".part":
            problems += [] if killed else [f"left {path.name}"]
        elif not is_whole(path) or (is_table(path) and not (killed and is_appended_to(path)) and not is_whole_table(path)):
            problems.append(f"torn {path.relative_to(cwd)}")
    return problems


def has_numbers_only(path):
    if path.suffix == ".vtu":
        return all(np.isfinite(array).all() for section in data_arrays(path).values() for array in section.values())
    return not NOT_A_NUMBER.search(path.read_text(errors="replace"))


def numbers_that_are_none(cwd):
    paths = [p for p in sorted(cwd.rglob("*.*")) if p.suffix in (".csv", ".json", ".vtu", ".log", ".svg") and is_whole(p)]
    return [f"no number in {p.name}" for p in paths if not has_numbers_only(p)]
