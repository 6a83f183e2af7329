"""Runs the benchmarks and whole runs of the program, and writes the table of their ratios. Started by scripts/bench."""

import argparse
import json
import math
import os
import re
import shutil
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TREE = ROOT / "build" / "release"
BENCH = TREE / "bench" / "kluft_bench"
KLUFT = TREE / "kluft"
RUNS = TREE / "bench" / "runs"
HEXAGONS = ROOT / "bench" / "hexagons.yaml"
FRACTURED = ROOT / "bench" / "fractured.yaml"
JOB = ROOT / "models" / "triaxial" / "case-3-all.yaml"

SIZES = [500, 5000, 50000, 200000]
PARTS = ["kernels", "runs", "shares", "job"]
GIB = 2.0**30
JOB_SPACINGS = [0.05, 0.03]
JOB_REPETITIONS = 2
EPILOG = """parts:
  kernels   assembly, factorization, solution and updates of the body of bench/hexagons.yaml (kluft_bench)
  runs      memory and time of elastic runs of the same bodies
  shares    where the time of a run with a mapped fracture goes (bench/fractured.yaml, about 50 000 blocks)
  job       models/triaxial/case-3-all.yaml to 2 % strain with and without reuse of the factor

Everything takes a quarter of an hour on two cores and 8 GB of memory; without the bodies of 200 000 blocks six minutes.
Nothing else should run on the machine. Raw results stay in build/release/bench/runs.

examples:
  scripts/bench
  scripts/bench --sizes 500,5000 --threads 1
  scripts/bench --parts kernels --sizes 5000,50000 -o results/bench.md
  scripts/bench --parts job
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
        raise MeasurementError(words[0])
    return done.stdout


# ---- measurements ----------------------------------------------------------------------------------------------------


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
        report = json.loads(file.read_text(encoding="utf-8"))
        self.context = report["context"]
        self.threads = options.threads[0]
        self.times = {}
        for entry in report["benchmarks"]:
            if entry["run_type"] != "iteration":
                continue
            name = re.sub(r"/(iterations:\d+|real_time)", "", entry["name"])
            self.times.setdefault(name, []).append(entry)

    def time(self, name, threads=None):
        """Seconds; `name` without its threads."""
        threads = threads or self.threads
        entries = self.times.get(f"{name}/threads:{threads}") or self.times.get(name)
        if not entries:
            return None
        clock = "cpu_time" if threads == 1 else "real_time"
        return 1e-3 * statistics.median(entry[clock] for entry in entries)  # from ms

    def wall_time(self, name, threads):
        return 1e-3 * statistics.median(entry["real_time"] for entry in self.times[f"{name}/threads:{threads}"])

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
    return json.loads((directory / "summary.json").read_text(encoding="utf-8"))


class ElasticRun:
    """An elastic run of bench/hexagons.yaml, and what `kluft check` says of its memory."""

    def __init__(self, size, options, kernels):
        overrides = [*hexagons(spacing_of(size)), "output.pictures=false"]
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
            if "runs" in options.parts:
                kernels = self.kernels.get(size)
                self.measure_into(self.runs, size, f"runs, {size} blocks", lambda: ElasticRun(size, options, kernels))
        if "shares" in options.parts:
            size = max((size for size in options.sizes if size <= 50000), default=min(options.sizes))
            self.shares = self.measure(f"shares, {size} blocks", lambda: shares_of(size, options))
        if "job" in options.parts:
            for spacing in JOB_SPACINGS:
                self.measure_into(self.jobs, spacing, f"main job, hexagons of {spacing} m", lambda: Job(spacing))

    def text(self):
        n = self.options.threads[0]
        head = f"{processor()}, {os.cpu_count()} cores, {n} thread{'s' if n > 1 else ''} where nothing else is said."
        legend = "F is one factorization and solution. A target stands in brackets; bold: missed."
        parts = ["# Benchmarks", f"{head} {legend}"]
        if self.load_at_start > 0.5:
            parts.append(f"Other programs were running: load average {self.load_at_start:.1f} at the start.")
        singles = growth_rows(self.kernels) + speed_up_rows(self.kernels, self.options.threads)
        singles += job_rows(self.jobs.values())
        parts += [body_table(self.options.sizes, self.kernels, self.runs),
                  table(["ratio", ""], singles) if singles else "",
                  shares_table(*self.shares) if self.shares else ""]
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


def arguments():
    parser = argparse.ArgumentParser(
        prog="scripts/bench", epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter,
        description="Builds and runs the benchmarks; writes a table in which everything is a ratio within one run.")
    parser.add_argument("--sizes", type=numbers, default=SIZES, metavar="N,N",
                        help="blocks of the bodies, 500,5000,50000,200000 by default")
    parser.add_argument("--threads", type=numbers, default=[1, 2] if (os.cpu_count() or 1) > 1 else [1], metavar="N,N",
                        help="threads of the BLAS: the first number for all rows, others for the speed-up; default 1,2")
    parser.add_argument("--parts", type=parts_of, default=PARTS, metavar="PART,PART", help="some of " + ",".join(PARTS))
    parser.add_argument("--repetitions", type=int, default=3, metavar="N",
                        help="of the kernels up to 100 000 blocks, whose median counts; 3 by default")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "bench" / "results.md", metavar="FILE",
                        help="table, bench/results.md by default")
    options = parser.parse_args()
    options.sizes = sorted(set(options.sizes))
    options.threads_text = ",".join(str(n) for n in options.threads)
    return options


def main():
    options = arguments()
    RUNS.mkdir(parents=True, exist_ok=True)
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
