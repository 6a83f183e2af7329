"""Every block of the kept states of runs of many kinds is in balance by the files of its forces alone, as well as history.csv says.

usage: blocks_in_balance.py KLUFT WORK_DIRECTORY
"""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.dont_write_bytecode = True
sys.path.append(str(ROOT / "validation/balance"))
import balance  # noqa: E402

ROCK = {"rock": {"density": 2500, "youngs_modulus": "10 GPa", "poissons_ratio": 0.2, "cohesion": "5 MPa", "friction_angle": 40,
                 "tensile_strength": "2 MPa"}}
JOINT = {"kind": "fracture", "normal_stiffness": 1e10, "shear_stiffness": 1e10, "friction_angle": 35}
SLOPE = {
    "kluft": 1, "analysis": {"plane": "stress", "gravity": [2.0, -9.8]}, "materials": ROCK, "interfaces": {"joint": JOINT},
    "geometry": {"domain": {"rectangle": {"width": 4, "height": 2.5}}, "reference_spacing": 1.0,
                 "fractures": [{"trace": [[-9, 0.5], [9, 0.5]], "interface": "joint"}, {"trace": [[1.3, 0.5], [1.3, 9]], "interface": "joint"},
                               {"trace": [[2.6, 0.5], [2.6, 9]], "interface": "joint"}, {"trace": [[-1, 1.5], [9, 1.5]], "interface": "joint"}]},
    "boundaries": {"bottom": {"support": "fixed"}}, "stages": [{"name": "weight", "steps": 2}]}
INTACT = {
    "kluft": 1, "analysis": {"plane": "strain"}, "materials": ROCK,
    "interfaces": {"bond": {"kind": "potential_crack", "fails_to": "crack"}, "crack": {"kind": "fracture", "friction_angle": 35}},
    "geometry": {"domain": {"rectangle": {"width": 0.5, "height": 1}}, "tessellation": {"triangles": {"spacing": 0.15}, "interface": "bond"}},
    "boundaries": {"bottom": {"support": "smooth"}},
    "stages": [{"name": "sides", "pressure": {"left": "0.5 MPa", "right": "0.5 MPa", "top": "0.5 MPa"}, "steps": 1},
               {"name": "platen", "strain": {"boundary": "top", "value": "0.05 %"}, "steps": 2}]}


def changed(scene, **values):
    """A copy with other values by key paths, dots as two underscores."""
    copy = json.loads(json.dumps(scene))
    for path, value in values.items():
        *parents, last = path.split("__")
        place = copy
        for key in parents:
            place = place[int(key)] if isinstance(place, list) else place.setdefault(key, {})
        place[int(last) if isinstance(place, list) else last] = value
    return copy


QUICK = ["--set", "geometry.tessellation.triangles.spacing=0.05", "--set", "stages.1.steps=20", "--set", "output.fields_every=4"]
SCENES = {
    "a specimen that breaks": (ROOT / "models/quickstart.yaml", QUICK),
    "a slope under its weight": (SLOPE, []),
    "a slope far from the origin": (changed(SLOPE, geometry__domain={"rectangle": {"width": 4, "height": 2.5, "origin": [5e5, 6.7e6]}},
                                            geometry__fractures=[{"trace": [[5e5 - 1, 6.7e6 + 0.5], [5e5 + 9, 6.7e6 + 0.5]], "interface": "joint"}]), []),
    "rigid blocks on a slope": (changed(SLOPE, analysis__kinematics="rigid"), []),
    "rough platens": (changed(INTACT, stages__1__platens="rough"), []),
    "platens with friction": (changed(INTACT, stages__1__platens={"friction_angle": 5}), []),
    "a platen under stress": (changed(INTACT, stages__1={"name": "platen", "stress": {"boundary": "top", "value": "3 MPa"}, "steps": 2}), []),
    "rigid hexagons": (changed(INTACT, geometry__tessellation={"hexagons": {"spacing": 0.1}, "interface": "bond"},
                               analysis__kinematics="rigid"), []),
    "a slope that slides": (changed(SLOPE, stages=[{"name": "weight", "steps": 2}, {"name": "tilt", "gravity": [9.0, -6.0], "steps": 5}]), []),
    "small time steps": (changed(SLOPE, analysis__integrator="explicit"), []),
}
SAME = 10.0  # ratio of two measures of what is left over: of the size of a block, of groups of blocks and of round-off
ROUNDOFF = 1e-7  # of a block's own forces: what digits of places and stiff contacts leave


def run(kluft, scene, words, directory):
    shutil.rmtree(directory, ignore_errors=True)
    directory.mkdir(parents=True)
    path = scene
    if isinstance(scene, dict):
        path = directory / "given.yaml"
        path.write_text(json.dumps(scene | {"output": {"pictures": False}}))
    end = subprocess.run([kluft, "run", path, "-o", directory / "out", "--quiet", *words], capture_output=True, text=True)
    if end.returncode != (3 if "slides" in directory.name else 0):
        raise RuntimeError(f"{directory.name}: exit {end.returncode}: {end.stderr}")
    return directory / "out"


def problems_of(name, out):
    history = balance.history_of(out)
    checked = 0
    for step in balance.kept_steps(out):
        row = history[step]
        found = balance.balance_of(out, step)
        said = float(row["balance_error"])
        print(f"{name}, step {step}: {found.largest:.2e} left over, {said:.2e} in history.csv, unbalanced_ratio "
              f"{float(row['unbalanced_ratio']):.1e}, balanced {row['balanced']}, {len(found.block)} blocks")
        is_same = found.largest <= SAME * said + ROUNDOFF and said <= SAME * found.largest + ROUNDOFF
        if row["balanced"] == "1" and not is_same:
            yield f"{name}, step {step}: {found.largest:.3g} left over, and {said:.3g} in history.csv"
        checked += found.own.max(initial=0.0) > 0.0
    if row["balanced"] != "1" or checked == 0:
        yield f"{name}: expected a balanced state with forces at the end"


def sees_what_is_wrong(out):
    """A hundredth more on one contact is found, on the block that has it, and the program says so."""
    step = balance.kept_steps(out)[-1]
    path = out / "contacts" / f"{step:06}.csv"
    text = path.read_text()
    lines = text.splitlines()
    names = lines[0].split(",")
    rows = [line.split(",") for line in lines[1:]]
    pressed = int(np.argmax([abs(float(row[names.index("normal_traction")])) for row in rows]))
    rows[pressed][names.index("normal_traction")] = str(1.01 * float(rows[pressed][names.index("normal_traction")]))
    path.write_text("\n".join([lines[0], *[",".join(row) for row in rows]]) + "\n")
    code = balance.main([str(out)])
    path.write_text(text)
    if code != 1:
        yield f"a contact with a hundredth more is taken: exit {code}"
    if balance.main([str(out)]) != 0:
        yield "the files are not taken as they were"


def main(kluft, work):
    problems = []
    for name, (scene, words) in SCENES.items():
        out = run(kluft, scene, words, Path(work) / name.replace(" ", "-"))
        problems += problems_of(name, out)
        if name == "a slope under its weight":
            problems += sees_what_is_wrong(out)
    print("\n".join(problems) or f"{len(SCENES)} runs are in balance by their files")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
