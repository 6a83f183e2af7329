"""Forty scenes at the limits of the method: each ends in bounded time, done or with a diagnosis, and with numbers only."""

import json
import math
import random
import sys

from bench import DONE, NO_EQUILIBRIUM, ROOT, Trial, disagreement, numbers_that_are_none, torn_files

sys.path.insert(0, str(ROOT / "validation/extremes"))
import scenes  # noqa: E402

TIME_LIMIT_HERE = 300.0  # s
STIFFNESS = [1e-3, 1e-1, 1e1, 1e3, 1e6]  # k_n d/E


def all_scenes():
    """Name and scene, the dear ones last."""
    found = {}
    for ratio in STIFFNESS:
        found[f"column of joints, k_n d/E {ratio:g}"] = scenes.column(normal=ratio * 1e10, shear=0.5 * ratio * 1e10, strain=1e-3,
                                                                      steps=5, solver={"viscosity": 5e-3})
    for angle in (1e-2, 1e-4, 1e-6, 1e-8):
        found[f"needles, {angle:g} rad"] = scenes.wedge(angle, 1e6)
    for thickness in (1e-4, 1e-8):
        found[f"slab of {thickness:g}"] = scenes.slab(thickness)
    for strength in (1e4, 1e6):
        for pull in (True, False):
            found[f"snap-back, bar {'pulled' if pull else 'pressed'}, {strength:g} Pa"] = scenes.bar(strength, 30, strength, pull, modulus=1e7, normal=1e12)
    for spacing in (0.03, 0.015):
        found[f"snap-back, pulled net of {spacing}"] = pulled_net(spacing)
    for angle in (20, 31, 45, 80):
        found[f"mechanism, slope of {angle} degrees"] = slope(angle)
    for friction, share in ((0, 0.5), (30, 2.0)):
        found[f"mechanism, pushed block, {friction} degrees"] = scenes.pushed_block(friction, share)
    for n in (3, 12):
        found[f"mechanism, tower of {n} leaning blocks"] = tower(n)
    for n, seed in ((5, 1), (8, 2), (12, 3), (20, 4)):
        found[f"map of {n} random traces with a net"] = random_map(n, seed)
    for length, stress in ((1e-6, 1.0), (1e5, 1.0), (1.0, 1e-6), (1.0, 1e5), (1e-4, 1e4), (1e4, 1e-4)):
        found[f"units, {length:g} m and {stress:g} Pa"] = triaxial(length=length, stress=stress)
    for ratio in STIFFNESS:
        found[f"net, k_n d/E {ratio:g}"] = triaxial(ratio=ratio, stress=0.01)
    return found


def triaxial(ratio=None, **units):
    """The triaxial test with the solver's defaults, crack by crack; with k_n d = ratio E."""
    scene = scenes.triaxial(solver={}, update="event", **units)
    if ratio is not None:
        stiffness = ratio * scene["materials"]["sandstone"]["youngs_modulus"]
        for kind in scene["interfaces"].values():
            kind |= {"normal_stiffness_times_spacing": stiffness, "shear_stiffness_times_spacing": 0.5 * stiffness}
    return scene


def pulled_net(spacing):
    """A brittle net that stores much more energy than its cracks take."""
    scene = scenes.triaxial(steps=20)
    scene["geometry"]["fractures"] = []
    scene["geometry"]["tessellation"] = {"triangles": {"spacing": 2 * spacing}, "interface": "rock_bond"}
    scene["stages"] = [{"name": "platen", "strain": {"boundary": "top", "value": -5e-3, "glued": True}, "steps": 20}]
    scene["boundaries"] = {"bottom": {"support": "fixed"}}
    return scene | {"solver": {}, "cracks": {"update": "event"}}


def slope(angle):
    """Three blocks on a plane, under gravity that is turned by the plane's angle; joints of 30 degrees."""
    blocks = [scenes.square("base", -5, -12, 12, support="fixed")] + [scenes.square(f"b{i}", 1.0 * i, 0) for i in range(3)]
    gravity = [10 * math.sin(math.radians(angle)), -10 * math.cos(math.radians(angle))]
    return scenes.given(blocks, [{"name": "weight", "steps": 5}], gravity=gravity, solver={"viscosity": 5e-3})


def tower(n):
    """Each block stands out by a fifth beyond the one below."""
    blocks = [scenes.square("base", -2, -4, 4, support="fixed")] + [scenes.square(f"b{i}", 0.2 * i, i) for i in range(n)]
    return scenes.given(blocks, [{"name": "weight", "steps": 5}], gravity=[0, -10], solver={"viscosity": 5e-3})


def random_map(n, seed):
    rng = random.Random(seed)
    traces = [{"trace": [[rng.uniform(-0.1, 1.1), rng.uniform(-0.1, 1.1)] for _ in range(2)], "interface": "joint"} for _ in range(n)]
    scene = scenes.triaxial(steps=5)
    scene["geometry"] = {"domain": {"rectangle": {"width": 1, "height": 1}}, "fractures": traces,
                         "tessellation": {"triangles": {"spacing": 0.15}, "interface": "rock_bond"}}
    return scene | {"solver": {}, "cracks": {"update": "event"}}


SCENES = list(all_scenes().items())


def hard(bench, i):
    if bench.is_short and i >= len(SCENES) - len(STIFFNESS):
        return None  # the dear ones
    name, scene = SCENES[i]
    cwd = bench.place("hard", i)
    (cwd / "scene.yaml").write_text(json.dumps(scene | {"output": {"pictures": False, "fields": True}}))
    words = ["run", str(cwd / "scene.yaml"), "-o", "out", "--quiet"]
    end = bench.call(words, cwd, limit=TIME_LIMIT_HERE)
    problems = end.crash()
    if not problems and end.code not in (DONE, NO_EQUILIBRIUM):
        problems.append(f"exit {end.code}: {end.said()}")
    problems += disagreement(end.code, cwd / "out") + torn_files(cwd) + numbers_that_are_none(cwd)
    return Trial(f"{name}: exit {end.code}", problems, bench.shell(words))


KINDS = {"hard scenes": (hard, 2, len(SCENES))}
