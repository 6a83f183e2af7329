"""What each feature costs a run that has it, and one that does not. Started by `scripts/bench pay_for_use`."""

import argparse
import json
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
KLUFT = ROOT / "build" / "release" / "kluft"
RUNS = ROOT / "build" / "release" / "bench" / "pay_for_use"
HEXAGONS = ROOT / "bench" / "hexagons.yaml"
JOB = ROOT / "models" / "triaxial" / "case-3-all.yaml"
ALLOWED = 0.02

N_COURSES = 22
EPILOG = """Two tables. Absent: instructions that the functions of a feature run in a scene without it, over those of the whole
run, counted by valgrind (callgrind); exact, and the same on a busy machine. Present: processor time of the run with the
feature over that of the run without it, the median of pairs of runs that follow each other in changing order.

examples:
  scripts/bench pay_for_use
  scripts/bench pay_for_use --repetitions 9 --spacing 0.0152
"""

# Scenes without features; what differs from bench/hexagons.yaml (bonded hexagons under pressure, then a platen).
PLAIN = {
    "stages.1.steps": 30,
    "cracks.update": "all",
    "output.fields": "false",
    "output.pictures": "false",
    "output.report": "false",
}
BONDED = PLAIN
FRACTURES = PLAIN | {"geometry.tessellation.interface": "joint", "interfaces.joint.friction_angle": "45 deg"}
# The same in a wall of bricks, which needs no exact arithmetic to be cut: that changes the rounding mode of the processor,
# which valgrind cannot do.
WALL = PLAIN
LOOSE_WALL = PLAIN | {"geometry.blocks_interface": "joint", "interfaces.joint.friction_angle": "45 deg"}
REFACTORED_WALL = LOOSE_WALL | {"solver.reuse": "false"}

# Feature -> (scene without it, its functions by the beginning of their names). None of them calls another one of its row.
ABSENT = {
    "potential cracks": ("fractures", ["check_cracks", "weaken_together", "bond_tractions", "place_bonds", "bonded_interfaces"]),
    "friction": ("bonded", ["fracture_traction", "contact_traction"]),
    "contact detection": ("bonded", ["detect_contacts"]),
    "point forces and gravity": ("bonded", ["external_forces"]),
    "field files": ("bonded", ["field_record", "fields_of_state", "blocks_vtu", "interfaces_vtu", "FieldSeries::"]),
    "pictures": ("bonded", ["RunWriter::write_pictures", "draw_blocks", "draw_curves"]),
    "histories": ("bonded", ["measure_histories", "histories_row", "place_histories"]),
    "rigid blocks": ("bonded", ["RigidTurns::", "EquilibriumEvaluator::rigid_tangent"]),
    "reuse of the factor": ("refactored", ["StiffnessReference::take", "StiffnessReference::changes", "LowRankUpdate::"]),
    "strength reduction": ("bonded", ["reduced_strengths"]),
}
ABSENT_SCENES = {"bonded": WALL, "fractures": LOOSE_WALL, "refactored": REFACTORED_WALL}

HISTORY = "{" + ", ".join(f"p{i}: {{point: [{0.2 * i + 0.1:.1f}, 0.5]}}" for i in range(4)) + "}"

# Feature -> (scene, what differs without it, what differs with it).
JOB_RUN = {"stages.1.strain.value": "1.5 %", "stages.1.steps": 50, "cracks.update": "all",
           "output.fields": "false", "output.pictures": "false",
           "output.report": "false"}
PRESENT = {
    "potential cracks, checked in each load step": (HEXAGONS, BONDED | {"cracks.every": 1000}, BONDED),
    "event search, nothing fails": (HEXAGONS, BONDED, BONDED | {"cracks.update": "event"}),
    "event search, cracking": (JOB, JOB_RUN, JOB_RUN | {"cracks.update": "event"}),
    "friction and detection on every interface": (HEXAGONS, BONDED, FRACTURES),
    "gravity": (HEXAGONS, BONDED, BONDED | {"analysis.gravity": 9.81}),
    "field files, first and last state": (HEXAGONS, BONDED, BONDED | {"output.fields": "true"}),
    "field files of each load step": (HEXAGONS, BONDED, BONDED | {"output.fields": "true", "output.fields_every": 1}),
    "pictures": (HEXAGONS, BONDED, BONDED | {"output.pictures": "true"}),
    "histories of four points": (HEXAGONS, BONDED, BONDED | {"output.histories": HISTORY}),
    "rigid instead of affine blocks, bonded": (HEXAGONS, BONDED, BONDED | {"analysis.kinematics": "rigid"}),
    "rigid instead of affine blocks, cracking": (JOB, JOB_RUN, JOB_RUN | {"analysis.kinematics": "rigid"}),
    "reuse of the factor, bonded": (HEXAGONS, BONDED | {"solver.reuse": "false"}, BONDED),
    "reuse of the factor, cracking": (JOB, JOB_RUN | {"solver.reuse": "false"}, JOB_RUN),
}


def say(text):
    print(text, file=sys.stderr, flush=True)


def command(scene, settings, spacing, directory):
    shutil.rmtree(directory, ignore_errors=True)
    words = [KLUFT, "run", scene, "-o", directory, "--quiet", "--threads", 1]
    if scene == HEXAGONS:
        settings = {"geometry.tessellation.hexagons.spacing": spacing, **settings}
    for key, value in settings.items():
        words += ["--set", f"{key}={value}"]
    return [str(word) for word in words]


def run(words):
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"pay_for_use: {done.stderr.strip().splitlines()[-1]}")
    return done


# ---- absent ----------------------------------------------------------------------------------------------------------


def write_wall(file):
    """A square of 1 m2 of bricks in running bond with the rest of bench/hexagons.yaml."""
    n = N_COURSES
    blocks = []
    for row in range(n):
        ends = [0, *range(1 + row % 2, 2 * n, 2), 2 * n]
        ends = sorted(set(ends))
        for left, right in zip(ends, ends[1:]):
            x, y = (left / (2 * n), right / (2 * n)), (row / n, (row + 1) / n)
            corners = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]
            blocks.append({"polygon": corners})
    geometry = {"domain": None, "tessellation": None, "blocks": blocks, "blocks_interface": "bond",
                "reference_spacing": 1 / n}
    file.write_text(f"extends: {HEXAGONS}\nkluft: 1\ngeometry: {json.dumps(geometry)}\n", encoding="utf-8")


def instructions(scene):
    """Inclusive instruction counts of a run by function, and their sum under the key ''."""
    if shutil.which("valgrind") is None:
        raise SystemExit("pay_for_use: counting instructions needs valgrind (apt-get install valgrind), or --only present")
    file = RUNS / f"callgrind.{scene}"
    run(["valgrind", "--tool=callgrind", f"--callgrind-out-file={file}",
         *command(RUNS / "wall.yaml", ABSENT_SCENES[scene], None, RUNS / "out")])
    text = run(["callgrind_annotate", "--inclusive=yes", "--threshold=100", "--show-percs=no", str(file)]).stdout
    counts = {}
    for line in text.splitlines():
        found = re.match(r"\s*([\d,]+)\s+(PROGRAM TOTALS|\S.*)", line)
        if not found:
            continue
        count = int(found[1].replace(",", ""))
        if found[2] == "PROGRAM TOTALS":
            counts[""] = count
            continue
        signature = found[2].split(":", 1)[-1].replace("(anonymous namespace)::", "")
        name = re.search(r"kluft::([\w:~]+)", signature.split("(", 1)[0])
        if name:
            counts[name[1]] = counts.get(name[1], 0) + count
    return counts


def require_functions():
    """A function that was renamed would look as if it never ran."""
    symbols = run(["nm", "-C", str(KLUFT)]).stdout.replace("(anonymous namespace)::", "")
    for feature, (_, names) in ABSENT.items():
        for name in names:
            if f" kluft::{name}" not in symbols:
                raise SystemExit(f"pay_for_use: the program has no function {name} ({feature})")


def absent_rows():
    require_functions()
    write_wall(RUNS / "wall.yaml")
    counted = {}
    for feature, (scene, names) in ABSENT.items():
        if scene not in counted:
            say(f"instructions of the scene '{scene}' ...")
            counted[scene] = instructions(scene)
        counts = counted[scene]
        own = {name: count for name, count in counts.items() if name and any(name.startswith(n) for n in names)}
        yield feature, scene, sum(own.values()) / counts[""], ", ".join(f"`{name}`" for name in sorted(own)) or "none runs"


# ---- present ---------------------------------------------------------------------------------------------------------


def processor_seconds(words):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run(words)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def present_rows(spacing, repetitions):
    for feature, (scene, without, with_it) in PRESENT.items():
        say(f"with and without: {feature} ...")
        ratios, base = [], []
        for i in range(repetitions):
            order = [0, 1] if i % 2 == 0 else [1, 0]
            seconds = [0.0, 0.0]
            for k in order:
                seconds[k] = processor_seconds(command(scene, (without, with_it)[k], spacing, RUNS / f"out-{k}"))
            ratios.append(seconds[1] / seconds[0])
            base.append(seconds[0])
        solves = [json.loads((RUNS / f"out-{k}" / "summary.json").read_text())["open_close_iterations"] for k in (0, 1)]
        ratios.sort()
        yield feature, statistics.median(ratios), ratios[len(ratios) // 4], ratios[-1 - len(ratios) // 4], statistics.median(base), solves


# ---- table -----------------------------------------------------------------------------------------------------------


def processor():
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return "unknown processor"


def table(absent, present, options):
    lines = ["# Only what a scene requires", "",
             f"`scripts/bench pay_for_use --spacing {options.spacing} --repetitions {options.repetitions}`, {processor()}, "
             f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors at the end. What is measured and why:",
             "[README.md](README.md#only-what-a-scene-requires).", ""]
    if absent:
        lines += [f"## Absent: share of the instructions of a run (at most {ALLOWED:g})", "",
                  "| feature | scene without it | share | its functions that run |", "|---|---|---|---|"]
        for feature, scene, share, names in absent:
            text = f"{share:.2g}" if share <= ALLOWED else f"**{share:.2g}**"
            lines.append(f"| {feature} | {scene} | {text} | {names} |")
        lines.append("")
    if present:
        lines += ["## Present: processor time with over without", "",
                  "| feature | ratio | middle half of the pairs | without (s) | solves without, with |", "|---|---|---|---|---|"]
        for feature, ratio, low, high, base, solves in present:
            lines.append(f"| {feature} | {ratio:.3f} | {low:.3f}-{high:.3f} | {base:.2f} | {solves[0]}, {solves[1]} |")
        lines.append("")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(prog="scripts/bench pay_for_use", description=__doc__, epilog=EPILOG,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spacing", type=float, default=0.0481, help="of the hexagons in m (default: 538 blocks)")
    parser.add_argument("--repetitions", type=int, default=5, help="pairs of runs (default 5)")
    parser.add_argument("--only", choices=["absent", "present"], help="one of the two tables")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "bench" / "pay_for_use.md", help="the table")
    options = parser.parse_args()
    RUNS.mkdir(parents=True, exist_ok=True)
    absent = list(absent_rows()) if options.only != "present" else []
    present = list(present_rows(options.spacing, options.repetitions)) if options.only != "absent" else []
    text = table(absent, present, options)
    options.output.write_text(text, encoding="utf-8")
    print(text)
    return 1 if any(share > ALLOWED for _, _, share, _ in absent) else 0


if __name__ == "__main__":
    sys.exit(main())
