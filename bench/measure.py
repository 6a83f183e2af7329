"""Runs the benchmarks and whole runs of the program, and writes the table of their ratios. Started by scripts/bench."""

import argparse
import json
import math
import os
import re
import shutil
import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "python"))  # its readers need NumPy only

from kluft.tables import read_table  # noqa: E402

TREE = ROOT / "build" / "release"
BENCH = TREE / "bench" / "kluft_bench"
KLUFT = TREE / "kluft"
RUNS = TREE / "bench" / "runs"
HEXAGONS = ROOT / "bench" / "hexagons.yaml"
FRACTURED = ROOT / "bench" / "fractured.yaml"
UNCONFINED = ROOT / "bench" / "unconfined.yaml"
JOB = ROOT / "models" / "triaxial" / "case-3-all.yaml"

SIZES = [500, 5000, 50000, 200000]
PARTS = ["kernels", "runs", "shares", "job", "walls", "collapse", "unconfined"]
GIB = 2.0**30
JOB_SPACINGS = [0.05, 0.03]
JOB_REPETITIONS = 2
WALLS = [(16, 20), (25, 40)]  # bricks in a row, rows: 331 and 1021 bricks with the base
PATCH = 524  # hexagons
NEARLY_ONE = [1.0 + 1e-6 * i for i in range(5)]  # factors of stiffnesses: equal but for what rounding makes of them
COLLAPSES = [("triangles", 0.04, 1.6), ("triangles", 0.02, 1.6), ("hexagons", 0.03, 2.5)]  # net, spacing (m), strain of the end (%)
LIMIT = 120.0
TIME_TO_STOP = 30.0  # seconds that an interrupted run gets to write its summary
NO_EQUILIBRIUM, INTERRUPTED = 3, 130  # exit codes of the program
EPILOG = """parts:
  kernels   assembly, factorization, solution and updates of the body of bench/hexagons.yaml (kluft_bench)
  runs      memory and time of elastic runs of the same bodies
  shares    where the time of a run with a mapped fracture goes (bench/fractured.yaml, about 50 000 blocks)
  job       models/triaxial/case-3-all.yaml to 2 % strain with and without reuse of the factor
  walls     solves and time of the load steps of walls of 331 and 1021 bricks with stiff joints under their weight,
            and of a patch of hexagons, five of each whose stiffnesses differ by millionths
  collapse  solves and time of models/triaxial/case-3-all.yaml to the peak and behind it
  unconfined
            how far a body of triangles without lateral pressure comes (bench/unconfined.yaml)

Runs of the last three parts that take longer than --limit are ended, and the table says so.
Everything takes more than a quarter of an hour on two cores and 8 GB of memory; without the bodies of 200 000 blocks
eight minutes.
Nothing else should run on the machine. Raw results stay in build/release/bench/runs.

examples:
  scripts/bench
  scripts/bench --sizes 500,5000 --threads 1
  scripts/bench --parts kernels --sizes 5000,50000 -o results/bench.md
  scripts/bench --parts job
  scripts/bench --parts walls,collapse,unconfined --limit 60
"""


class MeasurementError(Exception):
    """A measurement gave no result; the table says why."""


def say(text):
    print(text, file=sys.stderr, flush=True)


def spacing_of(n_blocks):
    """Lattice spacing that cuts about n_blocks hexagons from a square of 1 m2."""
    return float(f"{math.sqrt(2.0 / (math.sqrt(3.0) * n_blocks)):.3g}")


def set_options(overrides):
    return [word for override in overrides for word in ("--set", override)]


def hexagons(spacing):
    return [f"geometry.tessellation.hexagons.spacing={spacing}"]


def output_of(command):
    """Standard output of a program; MeasurementError with its last words where it fails."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        words = (done.stderr.strip() or done.stdout.strip() or f"exit code {done.returncode}").splitlines()
        raise MeasurementError(words[-1])
    return done.stdout


def read_json(file):
    """What a JSON file holds; MeasurementError where it is cut off or has a NaN or infinity, which JSON does not know."""
    def refuse(word):
        raise ValueError(f"{word} is no number of JSON")

    try:
        return json.loads(file.read_text(encoding="utf-8"), parse_constant=refuse)
    except (OSError, ValueError) as error:
        raise MeasurementError(f"{file.name}: {error}") from error


# ---- measurements ----------------------------------------------------------------------------------------------------


def median_seconds(entries):
    """By the clock, of entries of Google Benchmark."""
    return 1e-3 * statistics.median(entry["real_time"] for entry in entries)  # from ms


def seconds_of_factorization(name, scene, threads):
    """F of the body of a scene: one factorization and solution, by the clock."""
    file = RUNS / f"{name}-factorization.json"
    output_of([BENCH, scene, "--threads", threads, "--benchmark_filter=^refactorization", f"--benchmark_out={file}",
               "--benchmark_out_format=json", "--benchmark_min_time=0.1", "--benchmark_repetitions=3"])
    return median_seconds(entry for entry in read_json(file)["benchmarks"] if entry["run_type"] == "iteration")


class Kernels:
    """Median times of the benchmarks of one body. With one thread processor time, which other programs disturb less."""

    def __init__(self, size, options):
        repetitions = options.repetitions if size < 100000 else 1
        file = RUNS / f"kernels-{size}.json"
        command = [BENCH, HEXAGONS, *set_options(hexagons(spacing_of(size))), "--threads", options.threads_text]
        command += [f"--benchmark_out={file}", "--benchmark_out_format=json", "--benchmark_min_time=0.1"]
        command += [f"--benchmark_repetitions={repetitions}"]
        command += [f"--benchmark_enable_random_interleaving={'true' if repetitions > 1 else 'false'}"]
        output_of(command)
        report = read_json(file)
        self.context = report["context"]
        self.threads = options.threads[0]
        self.times = {}
        self.failures = {}
        for entry in report["benchmarks"]:
            if entry["run_type"] != "iteration":
                continue
            name = re.sub(r"/(iterations:\d+|real_time)", "", entry["name"])
            if entry.get("error_occurred"):
                self.failures[name] = entry["error_message"]
            else:
                self.times.setdefault(name, []).append(entry)
        if self.time("refactorization") is None:
            raise MeasurementError("; ".join(self.failures.values()) or "no factorization was measured")

    def time(self, name, threads=None):
        """Seconds; `name` without its threads."""
        threads = threads or self.threads
        entries = self.times.get(f"{name}/threads:{threads}") or self.times.get(name)
        if not entries:
            return None
        clock = "cpu_time" if threads == 1 else "real_time"
        return 1e-3 * statistics.median(entry[clock] for entry in entries)  # from ms

    def wall_time(self, name, threads):
        return median_seconds(self.times[f"{name}/threads:{threads}"])

    def per_refactorization(self, name, factor=1.0):
        seconds = self.time(name)
        return None if seconds is None else seconds / (factor * self.time("refactorization"))

    def worse(self, name, factor=1.0):
        """The worse of the placements of the changed points."""
        ratios = [self.per_refactorization(f"{name}/{placement}", factor) for placement in ("spread", "line")]
        return max((ratio for ratio in ratios if ratio is not None), default=None)

    def blas_share(self):
        dgemm = 2e9 / self.time("dgemm")
        return float(self.context["factor_flops"]) / self.time("factorization") / dgemm

    def speed_up(self, threads):
        return self.wall_time("factorization", 1) / self.wall_time("factorization", threads)

    @property
    def blocks(self):
        return int(self.context["blocks"])

    @property
    def factor_bytes(self):
        return float(self.context["factor_bytes"])


def run_program(name, scene, overrides, threads):
    """summary.json of a run of the program."""
    directory = RUNS / name
    shutil.rmtree(directory, ignore_errors=True)
    output_of([KLUFT, "run", scene, "-o", directory, "--quiet", "--threads", threads, *set_options(overrides)])
    return read_json(directory / "summary.json")


class LimitedRun:
    """A run of the program that is ended when the limit is over. That it finds no equilibrium is a result too."""

    def __init__(self, name, scene, overrides, options):
        directory = RUNS / name
        shutil.rmtree(directory, ignore_errors=True)
        command = [KLUFT, "run", scene, "-o", directory, "--quiet", "--threads", options.threads[0]]
        command += set_options(["output.pictures=false", "output.report=false", *overrides])
        with subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                              text=True) as process:
            self.exceeded, errors = wait_for(process, options.limit)
        if not self.exceeded and process.returncode not in (0, NO_EQUILIBRIUM):
            raise MeasurementError((errors.strip() or f"exit code {process.returncode}").splitlines()[-1])
        self.limit_text = f"> {options.limit:g} s"
        self.summary = None if self.exceeded else read_json(directory / "summary.json")
        self.rows = history(directory / "history.csv")
        if not self.rows:
            raise MeasurementError(f"no load step within {options.limit:g} s")

    @property
    def status(self):
        return self.limit_text if self.exceeded else self.summary["status"].replace("_", " ")

    @property
    def n_solves(self):
        return solves(self.rows)

    @property
    def n_steps(self):
        return sum(row["step"] > 0 for row in self.rows)

    @property
    def seconds(self):
        return self.rows[-1]["elapsed_s"]


def wait_for(process, limit):
    """Whether a process took longer than the limit, and its stderr. It is asked to stop before it is killed."""
    try:
        return False, process.communicate(timeout=limit)[1]
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGINT)
    try:
        return True, process.communicate(timeout=TIME_TO_STOP)[1]
    except subprocess.TimeoutExpired:
        process.kill()
        return True, process.communicate()[1]


def history(file):
    """The complete rows of history.csv as numbers; none where the run was ended before the first one."""
    if not file.exists():
        return []
    table = read_table(file)
    return [{name: float(row[name]) for name in table.dtype.names} for row in table]


def solves(rows):
    return int(sum(row["open_close_iterations"] for row in rows))


class ElasticRun:
    """An elastic run of bench/hexagons.yaml, and what `kluft check` says of its memory."""

    def __init__(self, size, options, kernels):
        overrides = [*hexagons(spacing_of(size)), "output.pictures=false", "output.report=false"]
        check = output_of([KLUFT, "check", HEXAGONS, *set_options(overrides)])
        self.estimate = 1e6 * float(re.search(r"^memory\s+about (\S+) MB", check, re.MULTILINE)[1])
        self.factor_bytes = kernels.factor_bytes if kernels else 1e6 * float(re.search(r"factor (\S+) MB", check)[1])
        self.summary = run_program(f"elastic-{size}", HEXAGONS, overrides, options.threads[0])

    @property
    def peak_bytes(self):
        return self.summary["peak_memory_bytes"]

    @property
    def kilobytes_per_block(self):
        return (self.peak_bytes - self.factor_bytes) / self.summary["blocks"] / 1e3

    @property
    def seconds_per_step(self):
        return self.summary["elapsed_s"] / self.summary["steps"]


def shares_of(size, options):
    """Shares of the time of a run with a mapped fracture, the ordering left out: it is made once."""
    summary = run_program(f"fractured-{size}", FRACTURED, hexagons(spacing_of(size)), options.threads[0])
    seconds = summary["seconds"]
    total = summary["elapsed_s"] - seconds["analysis"]
    shares = {name: value / total for name, value in seconds.items() if name != "analysis"}
    shares["the rest"] = 1.0 - sum(shares.values())
    return summary, shares


class Job:
    """The main job with and without reuse of the factor, by turns."""

    def __init__(self, spacing):
        self.spacing = spacing
        common = ["geometry.tessellation.triangles=null", *hexagons(spacing), "geometry.tessellation.hexagons.rotation=20",
                  "cracks.update=all", "stages.1.steps=100", "stages.1.strain.value=2 %"]
        self.summaries = {"true": [], "false": []}
        for i in range(JOB_REPETITIONS):
            for reuse, summaries in self.summaries.items():
                name = f"job-{spacing}-reuse-{reuse}-{i}"
                summaries.append(run_program(name, JOB, [*common, f"solver.reuse={reuse}"], 1))

    def best(self, reuse, key):
        return min(summary[key] for summary in self.summaries[reuse])

    @property
    def time_ratio(self):
        return self.best("true", "elapsed_s") / self.best("false", "elapsed_s")

    @property
    def peak_difference(self):
        return self.best("true", "peak_stress") / self.best("false", "peak_stress") - 1.0


def wall_scene(n_columns, n_rows, stiffness):
    """A wall of bricks of 2 m x 1 m in running bond on a fixed base under its weight, joints dry; stiffness in GPa/m."""
    width = 2 * n_columns
    lines = ["kluft: 1", "title: Wall of stiff joints under its weight", "analysis: {plane: strain}", "materials:",
             "  rock: {density: 2500 kg/m3, youngs_modulus: 1 GPa, poissons_ratio: 0.25}", "interfaces:",
             f"  joint: {{kind: fracture, normal_stiffness: {stiffness:.9g} GPa/m,"
             f" shear_stiffness: {stiffness:.9g} GPa/m, friction_angle: 35 deg, cohesion: 0}}", "geometry:", "  blocks:"]

    def add_brick(left, right, bottom, top, support=""):
        corners = f"[[{left}, {bottom}], [{right}, {bottom}], [{right}, {top}], [{left}, {top}]]"
        lines.append(f"    - {{polygon: {corners}{support}}}")

    add_brick(0, width, -1, 0, ", support: fixed")
    for row in range(n_rows):
        joints = range(0, width + 1, 2) if row % 2 == 0 else [0, *range(1, width, 2), width]
        for left, right in zip(joints, joints[1:]):
            add_brick(left, right, row, row + 1)
    lines += ["stages:", "  - {name: weight, gravity: [0, -9.81], steps: 100}"]
    return "\n".join(lines) + "\n"


def patch_scene(stiffness_ratio):
    """A square of 524 hexagons between smooth sides under its weight, joints dry."""
    return f"""kluft: 1
title: Patch of hexagons under its weight
analysis: {{plane: strain}}
materials:
  rock: {{density: 2500 kg/m3, youngs_modulus: 1 GPa, poissons_ratio: 0.25}}
interfaces:
  joint: {{kind: fracture, stiffness_ratio: {stiffness_ratio:.9g}, shear_ratio: 1.0, friction_angle: 35 deg, cohesion: 0}}
geometry:
  domain: {{rectangle: {{width: 20, height: 20}}}}
  tessellation: {{hexagons: {{spacing: 0.98}}, interface: joint}}
boundaries:
  bottom: {{support: pinned}}
  left: {{support: smooth}}
  right: {{support: smooth}}
stages:
  - {{name: weight, gravity: [0, -9.81], steps: 100}}
"""


class Wall:
    """Bodies of dry blocks under their weight whose stiffnesses hardly differ, and what a factorization of them takes.
    Rounding alone changes the number of linear solves by half, so that one of them says little."""

    def __init__(self, title, texts, options):
        self.title = title
        self.runs = []
        for i, text in enumerate(texts):
            scene = RUNS / f"{title.replace(' ', '-')}-{i}.yaml"
            scene.write_text(text, encoding="utf-8")
            if i == 0:
                self.factorization = seconds_of_factorization(scene.stem, scene, options.threads[0])
            self.runs.append(LimitedRun(scene.stem, scene, [], options))

    def spread(self, value):
        """Median of the runs with the least and the largest value; those that were ended count as infinite."""
        def text(number):
            return self.runs[0].limit_text if math.isinf(number) else digits(number)

        values = sorted(math.inf if run.exceeded else value(run) for run in self.runs)
        return f"{text(statistics.median(values))} ({text(values[0])} to {text(values[-1])})"


def wall(n_columns, n_rows, options):
    texts = [wall_scene(n_columns, n_rows, 50.0 * factor) for factor in NEARLY_ONE]  # k_n d/E is 50
    return Wall(f"{texts[0].count('polygon:')} bricks", texts, options)


def patch(options):
    return Wall(f"{PATCH} hexagons", [patch_scene(10.0 * factor) for factor in NEARLY_ONE], options)


def first_step(run):
    return next(row for row in run.rows if row["step"] == 1)


def seconds_per_step(run):
    return run.seconds / run.n_steps


class Collapse:
    """The specimen of the main job, pressed until it has lost some of its strength. The load step in which the stress
    begins to fall counts as behind the peak."""

    def __init__(self, net, spacing, strain, options):
        self.title = f"{net} of {spacing} m to {strain} %"
        overrides = [f"stages.1.strain.value={strain} %", f"stages.1.steps={round(strain / 0.02)}"]
        if net == "hexagons":
            overrides += ["geometry.tessellation.triangles=null", "geometry.tessellation.hexagons.rotation=20"]
        overrides.append(f"geometry.tessellation.{net}.spacing={spacing}")
        self.run = LimitedRun(f"collapse-{net}-{spacing}", JOB, overrides, options)
        rows = self.run.rows
        stresses = [row["axial_stress"] for row in rows]
        self.peak = stresses.index(max(stresses))
        self.has_peak = self.peak < len(rows) - 1

    @property
    def to_peak(self):
        return self.run.rows[:self.peak + 1]

    @property
    def behind_peak(self):
        return self.run.rows[self.peak + 1:]

    @property
    def seconds_to_peak(self):
        return self.to_peak[-1]["elapsed_s"]

    @property
    def seconds_behind_peak(self):
        return self.run.seconds - self.seconds_to_peak


# ---- the table -------------------------------------------------------------------------------------------------------


def digits(value):
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}" if abs(value) >= 1.0 else f"{value:.2g}"


def judged(value, target=None, relation="<="):
    """A value beside its target; bold where it misses it."""
    if value is None:
        return ""
    if target is None:
        return digits(value)
    low, high = target if isinstance(target, tuple) else (target, target)
    met = {"<=": value <= high, ">=": value >= low, "in": low <= value <= high}[relation]
    wanted = f"{low:g} to {high:g}" if relation == "in" else f"{'≤' if relation == '<=' else '≥'} {high:g}"
    text = f"{digits(value)} ({wanted})"
    return text if met else f"**{text}**"


def column_of(size):
    """Targets are given for 500, 5000, and 50 000 blocks or more."""
    return 0 if size < 2000 else 1 if size < 20000 else 2


# title, value of the kernels, targets, relation
KERNEL_ROWS = [
    ("assembly", lambda k: k.per_refactorization("tangent"), (0.12, 0.08, 0.03), "<="),
    ("assembly, all failed", lambda k: k.per_refactorization("fractured_tangent"), (0.12, 0.08, 0.03), "<="),
    ("residual", lambda k: k.per_refactorization("residual"), None, "<="),
    ("solution, K unchanged", lambda k: k.per_refactorization("solution"), (0.12, 0.20, 0.12), "<="),
    ("iteration, 10 points changed", lambda k: k.worse("iteration/10"), (0.25, 0.30, 0.15), "<="),
    ("iteration, 100 points changed", lambda k: k.worse("iteration/100"), (1.0, 0.60, 0.25), "<="),
    ("the same, tangent of friction, 10 points", lambda k: k.worse("frictional_iteration/10"), None, "<="),
    ("the same, tangent of friction, 100 points", lambda k: k.worse("frictional_iteration/100"), None, "<="),
    ("load step, 6 × 30 points changed, / 6 F", lambda k: k.worse("load_step", 6.0), (0.50, 0.45, 0.35), "<="),
    ("factorization rate / DGEMM rate", lambda k: k.blas_share(), (0.06, 0.15, 0.30), ">="),
]


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def grouped(number):
    return f"{number:,}".replace(",", " ")


def body_table(sizes, kernels, runs):
    known = {size: kernels.get(size) or runs.get(size) for size in sizes}
    sizes = [size for size in sizes if known[size]]
    rows = []
    for title, value, targets, relation in KERNEL_ROWS if kernels else []:
        cells = []
        for size in sizes:
            target = targets[column_of(size)] if targets else None
            cells.append(judged(value(kernels[size]), target, relation) if size in kernels else "")
        rows.append([title, *cells])
    if kernels and runs:
        both = {size: (kernels.get(size), runs.get(size)) for size in sizes}
        rows.append(["elastic load step", *[digits(seconds_in_factorizations(k, r)) if k and r else ""
                                            for k, r in both.values()]])
    if runs:
        measured = [runs.get(size) for size in sizes]
        rows.append(["peak memory beyond the factor, kB/block",
                     *[judged(r.kilobytes_per_block, 7.0 if size >= 5000 else None) if r else ""
                       for size, r in zip(sizes, measured)]])
        rows.append(["estimate of `kluft check` / peak memory",
                     *[judged(r.estimate / r.peak_bytes, (0.8, 1.2), "in") if r else "" for r in measured]])
        rows.append(["peak memory, GiB", *[judged(r.peak_bytes / GIB, 8.0 if size >= 200000 else None) if r else ""
                                           for size, r in zip(sizes, measured)]])
    blocks = [known[size].blocks if size in kernels else known[size].summary["blocks"] for size in sizes]
    return table(["blocks", *[grouped(n) for n in blocks]], rows) if rows else ""


def seconds_in_factorizations(kernels, run):
    return run.seconds_per_step / kernels.wall_time("refactorization", kernels.threads)


def exponent(small, large, name):
    return math.log(large.time(name) / small.time(name)) / math.log(large.blocks / small.blocks)


def growth_rows(kernels):
    sizes = [size for size in sorted(kernels) if size >= 5000]
    if len(sizes) < 2:
        return []
    small, large = kernels[sizes[0]], kernels[sizes[-1]]
    span = f", from {grouped(small.blocks)} to {grouped(large.blocks)} blocks"
    return [["exponent of assembly" + span, judged(exponent(small, large, "tangent"), 1.05)],
            ["exponent of the paths of 10 points" + span, judged(exponent(small, large, "path_set_up/10/spread"), 1.1)],
            ["exponent of factorization" + span, judged(exponent(small, large, "factorization"), 1.55)]]


def speed_up_rows(kernels, threads):
    if 1 not in threads or len(threads) < 2:
        return []
    rows = []
    for size, measured in sorted(kernels.items()):
        for n in threads:
            if n != 1:
                rows.append([f"factorization, speed-up of {n} threads, {grouped(measured.blocks)} blocks",
                             judged(measured.speed_up(n), 1.5 if n == 2 and size >= 50000 else None, ">=")])
    return rows


def job_rows(jobs):
    rows = []
    for job in jobs:
        title = f"main job, hexagons of {job.spacing} m: "
        rows.append([title + "time with reuse / without", judged(job.time_ratio, 0.4)])
        difference = judged(100.0 * job.peak_difference, (-0.5, 0.5), "in")
        rows.append([title + "peak with reuse / without - 1, %", difference])
    return rows


def walls_table(walls):
    def cells(value):
        return [wall.spread(lambda run, wall=wall: value(run, wall)) for wall in walls]

    def n_unbalanced(run):
        return sum(row["balanced"] == 0 for row in run.rows)

    rows = [["load steps made", *[str(min(run.n_steps for run in wall.runs)) for wall in walls]],
            ["of these out of balance", *[str(max(n_unbalanced(run) for run in wall.runs)) for wall in walls]],
            ["linear solves per load step", *cells(lambda run, _: run.n_solves / run.n_steps)],
            ["linear solves of the first load step", *cells(lambda run, _: first_step(run)["open_close_iterations"])],
            ["ms per load step, on this machine", *cells(lambda run, _: 1e3 * seconds_per_step(run))],
            ["share of the time in the first load step, %",
             *cells(lambda run, _: 100.0 * first_step(run)["elapsed_s"] / run.seconds)],
            ["time of a load step / F", *cells(lambda run, wall: seconds_per_step(run) / wall.factorization)]]
    head = f"walls, median of {len(NEARLY_ONE)} (least to largest)"
    return table([head, *[wall.title for wall in walls]], rows)


def collapse_table(collapses):
    def behind(value):
        return [value(each) if each.has_peak else each.run.limit_text if each.run.exceeded else "no peak"
                for each in collapses]

    rows = [["run", *[each.run.status for each in collapses]],
            ["strain at the peak, %", *behind(lambda each: digits(100.0 * each.to_peak[-1]["axial_strain"]))],
            ["strain at the end, %", *[digits(100.0 * each.run.rows[-1]["axial_strain"]) for each in collapses]],
            ["linear solves to the peak", *[grouped(solves(each.to_peak)) for each in collapses]],
            ["linear solves behind it", *behind(lambda each: grouped(solves(each.behind_peak)))],
            ["s to the peak, on this machine", *[digits(each.seconds_to_peak) for each in collapses]],
            ["s behind it, on this machine", *behind(lambda each: digits(each.seconds_behind_peak))],
            ["share of the time behind the peak, %",
             *behind(lambda each: digits(100.0 * each.seconds_behind_peak / each.run.seconds))],
            ["share of the solves behind the peak, %",
             *behind(lambda each: digits(100.0 * solves(each.behind_peak) / max(each.run.n_solves, 1)))]]
    return table(["main job beyond its peak", *[each.title for each in collapses]], rows)


def unconfined_table(run):
    balanced = [row for row in run.rows if row["balanced"] == 1]
    rows = [["run", run.status],
            ["strain of the last load step in balance, %", digits(100.0 * balanced[-1]["axial_strain"])],
            ["strain at the end, %", digits(100.0 * run.rows[-1]["axial_strain"])],
            ["load steps out of balance", str(len(run.rows) - len(balanced))],
            ["linear solves of the load steps in balance", grouped(solves(balanced))],
            ["linear solves", grouped(run.n_solves)],
            ["s, on this machine", digits(run.seconds)]]
    return table(["unconfined body of triangles", ""], rows)


def shares_table(summary, shares):
    small = {"detection", "set_up", "assembly", "crack_check", "output"}
    target = 5.0 if summary["blocks"] >= 50000 else None
    rows = [[name.replace("_", " "), judged(100.0 * share, target if name in small else None)]
            for name, share in sorted(shares.items(), key=lambda item: -item[1])]
    head = f"part of a load step, {grouped(summary['blocks'])} blocks, {summary['open_close_iterations']} iterations"
    return table([head, "%"], rows)


# ---- all of it -------------------------------------------------------------------------------------------------------


def processor():
    try:
        found = re.search(r"^model name\s*:\s*(.+)$", Path("/proc/cpuinfo").read_text(encoding="utf-8"), re.MULTILINE)
    except OSError:
        found = None
    return found[1].strip() if found else "unknown processor"


class Report:
    """What was measured, and what failed."""

    def __init__(self, options):
        self.options = options
        self.load_at_start = os.getloadavg()[0]
        self.kernels, self.runs, self.jobs, self.shares = {}, {}, {}, None
        self.walls, self.collapses, self.unconfined = {}, {}, None
        self.failures = []

    def measure(self, title, measurement):
        say(f"== {title}")
        start = time.monotonic()
        try:
            result = measurement()
        except MeasurementError as error:
            self.failures.append(f"{title}: {error}")
            say(f"   {error}")
            return None
        say(f"   {time.monotonic() - start:.0f} s")
        return result

    def measure_into(self, results, key, title, measurement):
        result = self.measure(title, measurement)
        if result is not None:
            results[key] = result

    def measure_all(self):
        options = self.options
        for size in options.sizes:
            if "kernels" in options.parts:
                self.measure_into(self.kernels, size, f"kernels, {size} blocks", lambda: Kernels(size, options))
                if size in self.kernels:
                    failures = self.kernels[size].failures
                    self.failures += [f"{name}, {size} blocks: {error}" for name, error in failures.items()]
            if "runs" in options.parts:
                kernels = self.kernels.get(size)
                self.measure_into(self.runs, size, f"runs, {size} blocks", lambda: ElasticRun(size, options, kernels))
        if "shares" in options.parts:
            size = max((size for size in options.sizes if size <= 50000), default=min(options.sizes))
            self.shares = self.measure(f"shares, {size} blocks", lambda: shares_of(size, options))
        if "job" in options.parts:
            for spacing in JOB_SPACINGS:
                self.measure_into(self.jobs, spacing, f"main job, hexagons of {spacing} m", lambda: Job(spacing))
        if "walls" in options.parts:
            for size in options.walls:
                self.measure_into(self.walls, size, f"wall, {size[1]} rows of bricks", lambda: wall(*size, options))
            self.measure_into(self.walls, PATCH, f"patch of {PATCH} hexagons", lambda: patch(options))
        if "collapse" in options.parts:
            for case in COLLAPSES:
                self.measure_into(self.collapses, case, f"collapse, {case[0]}", lambda: Collapse(*case, options))
        if "unconfined" in options.parts:
            self.unconfined = self.measure("unconfined", lambda: LimitedRun("unconfined", UNCONFINED, [], options))

    def text(self):
        n = self.options.threads[0]
        head = f"{processor()}, {os.cpu_count()} cores, {n} thread{'s' if n > 1 else ''} where nothing else is said."
        legend = "F is one factorization and solution. A target stands in brackets; bold: missed."
        if self.walls or self.collapses or self.unconfined:
            legend += f" A run of walls, collapse or unconfined may take {self.options.limit:g} s."
        parts = ["# Benchmarks", f"{head} {legend}"]
        if self.load_at_start > 0.5:
            parts.append(f"Other programs were running: load average {self.load_at_start:.1f} at the start.")
        singles = growth_rows(self.kernels) + speed_up_rows(self.kernels, self.options.threads)
        singles += job_rows(self.jobs.values())
        parts += [body_table(self.options.sizes, self.kernels, self.runs),
                  table(["ratio", ""], singles) if singles else "",
                  shares_table(*self.shares) if self.shares else "",
                  walls_table(self.walls.values()) if self.walls else "",
                  collapse_table(self.collapses.values()) if self.collapses else "",
                  unconfined_table(self.unconfined) if self.unconfined else ""]
        parts += [f"Not measured: {failure}" for failure in self.failures]
        return "\n\n".join(part for part in parts if part) + "\n"


def numbers(text):
    try:
        values = [int(word) for word in text.split(",")]
    except ValueError:
        values = []
    if not values or min(values) < 1:
        raise argparse.ArgumentTypeError(f"expected whole numbers like 500,5000, found '{text}'")
    return values


def parts_of(text):
    parts = text.split(",")
    for part in parts:
        if part not in PARTS:
            raise argparse.ArgumentTypeError(f"expected some of {', '.join(PARTS)}, found '{part}'")
    return parts


def seconds(text):
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"expected a number of seconds above 0, found '{text}'")
    return value


def arguments():
    parser = argparse.ArgumentParser(
        prog="scripts/bench", epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Builds and runs the benchmarks; writes a table in which nearly everything is a count or a ratio "
                    "within one run.")
    parser.add_argument("--sizes", type=numbers, default=SIZES, metavar="N,N",
                        help="blocks of the bodies, 500,5000,50000,200000 by default")
    parser.add_argument("--threads", type=numbers, default=[1, 2] if (os.cpu_count() or 1) > 1 else [1], metavar="N,N",
                        help="threads of the BLAS: the first number for all rows, others for the speed-up; default 1,2")
    parser.add_argument("--parts", type=parts_of, default=PARTS, metavar="PART,PART", help="some of " + ",".join(PARTS))
    parser.add_argument("--repetitions", type=int, default=3, metavar="N",
                        help="of the kernels up to 100 000 blocks, whose median counts; 3 by default")
    parser.add_argument("--limit", type=seconds, default=LIMIT, metavar="SECONDS",
                        help=f"of each run of walls, collapse and unconfined; {LIMIT:g} by default")
    parser.add_argument("--check", action="store_true",
                        help="no table: only whether small bodies are measured without gaps, in half a minute")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "bench" / "results.md", metavar="FILE",
                        help="table, bench/results.md by default")
    options = parser.parse_args()
    options.sizes = sorted(set(options.sizes))
    options.walls = WALLS
    options.threads_text = ",".join(str(n) for n in options.threads)
    return options


def check(options):
    """What is wrong with the measurements of small bodies, each of which takes a second."""
    options.sizes, options.walls, options.repetitions = [3, 20, 100], [(4, 4)], 2
    options.parts = ["kernels", "runs", "shares", "walls"]
    report = Report(options)
    report.measure_all()
    text = report.text()
    problems = list(report.failures)
    if 100 in report.kernels:  # smaller ones have too few interfaces for some rows
        kernels = report.kernels[100]
        problems += [f"100 blocks: no value of '{row[0]}'" for row in KERNEL_ROWS if row[1](kernels) is None]
    if re.search(r"\b(nan|inf|None)\b", text):
        problems.append("the table has numbers that are none:\n" + text)
    options.limit = 0.2
    stopped = report.measure("a run that is ended", lambda: wall(*WALLS[-1], options))
    if stopped is None or "> 0.2 s" not in walls_table([stopped]):
        problems.append("a run that takes longer than the limit is not told as such")
    return problems


def main():
    options = arguments()
    RUNS.mkdir(parents=True, exist_ok=True)
    if options.check:
        problems = check(options)
        print("\n".join(problems) or "all is measured")
        return 1 if problems else 0
    report = Report(options)
    report.measure_all()
    text = report.text()
    options.output.parent.mkdir(parents=True, exist_ok=True)
    options.output.write_text(text, encoding="utf-8")
    print(text, end="")
    say(f"written to {options.output}")
    return 1 if report.failures else 0


if __name__ == "__main__":
    sys.exit(main())
