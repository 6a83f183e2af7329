"""The points of the campaign: what is swept, over which values, and how each is judged."""

import math
from dataclasses import dataclass

import numpy as np

import scenes
from verdict import Check


@dataclass
class Point:
    """`scenes` are run one after the other; `judge` gets their outcomes and returns checks. `may_fall`, per scene: it need not
    end as `done`, the judge looks at that itself. `target`: it has to be right."""

    extreme: str
    value: str
    body: str
    scenes: list
    judge: object
    target: bool = False
    limit: float = 20.0
    may_fall: list | None = None
    quick: bool = False
    no_equilibrium: bool = False  # there is none: to find one is wrong


def powers(low, high, step=1):
    return [10.0**k for k in range(low, high + 1, step)]


# ---- judges -------------------------------------------------------------------------------------------------------


def axial_stiffness(expected, tolerance=1e-6):
    def judge(outcomes):
        last = outcomes[0].last
        return [Check("stress/strain", expected, last["axial_stress"] / last["axial_strain"], tolerance)]

    return judge


def hydrostatic(pressure, strain=None, tolerance=1e-6):
    def judge(outcomes):
        blocks = outcomes[0].blocks()
        checks = [Check(f"stress_{name}/p", expected, worst(blocks[f"stress_{name}"] / pressure, expected), tolerance)
                  for name, expected in (("xx", -1.0), ("yy", -1.0), ("xy", 0.0))]
        if strain is not None:
            checks.append(Check("strain of the net", strain, outcomes[0].last["axial_strain"], tolerance))
        return checks

    return judge


def worst(values, expected):
    return float(values[np.argmax(np.abs(values - expected))])


def nearly_same_stresses(pressure, tolerance):
    """Slivers are merged: what is left is the net with the joint on the edges."""

    def judge(outcomes):
        first, second = (outcome.blocks() for outcome in outcomes)
        return [Check(f"{name} of stress_{axis} over p", select(first[f"stress_{axis}"]) / pressure, select(second[f"stress_{axis}"]) / pressure,
                      tolerance) for axis in ("xx", "yy") for name, select in (("least", np.min), ("largest", np.max))]

    return judge


def strip_moduli(modulus, poisson, normal, shear, spacing, tolerance=1e-6):
    """E and nu of the net, plane stress, from a block in the middle and the displacements around it."""
    bulk, rigidity = scenes.moduli(modulus, poisson, normal, shear, spacing)
    young, ratio = 2 * bulk * rigidity / (bulk + rigidity), (bulk - rigidity) / (bulk + rigidity)

    def judge(outcomes):
        blocks = outcomes[0].blocks()
        centres, motion = blocks.middles(), blocks.mean_displacements()
        row = scenes.ROW * spacing
        middle = blocks.nearest((20 * spacing, 2 * row))
        x, y = centres[middle]
        right, left, upper = (blocks.nearest(at) for at in ((x + spacing, y), (x - spacing, y), (x, y + 2 * row)))
        strain_x = (motion[right, 0] - motion[left, 0]) / (2 * spacing)
        strain_y = (motion[upper, 1] - motion[middle, 1]) / (2 * row)
        return [Check("E of the net", young, blocks["stress_yy"][middle] / strain_y, tolerance),
                Check("1 + nu of the net", 1 + ratio, 1 - strain_x / strain_y, tolerance)]

    return judge


def slip_load(expected, tolerance=1e-5):
    def judge(outcomes):
        return [Check("p1 - p3 at slip", expected, outcomes[0].last["differential_stress"], tolerance)]

    return judge


def stands_and_slides(outcomes):
    """The first stands, the second does not: it is not done, or not in balance, or it has slid far."""
    stands, slides = (float(outcome.done and outcome.balanced) for outcome in outcomes)
    return [Check("block below its limit stands", 1.0, stands, 1e-9), Check("block above its limit slides", 0.0, slides, 1e-9)]


def peak(expected, tolerance=1e-6):
    def judge(outcomes):
        history = outcomes[0].equilibria["axial_stress"]
        return [Check("strength", expected, float(np.max(np.abs(history))), tolerance)]

    return judge


COUNTS = ("step", "stage", "cracks_tension", "cracks_shear", "open", "sliding", "locked", "crack_passes", "balanced")
STRESSES = ("axial_stress", "lateral_stress", "differential_stress")
STRAINS = ("axial_strain", "lateral_strain", "volumetric_strain")


def same_as_twin(stress=1.0, tolerance=1e-9, iterations=True):
    """The histories and summaries of two runs, in units of their own; stresses of the second are `stress` times the first's."""

    def judge(outcomes):
        first, second = outcomes
        if first.n_steps != second.n_steps:
            return [Check("rows", first.n_steps, second.n_steps, 1e-12)]
        checks = [column_check(name, first.history[name], second.history[name], 1e-12) for name in COUNTS]
        checks += [column_check(name, first.history[name], second.history[name] / stress, tolerance) for name in STRESSES]
        checks += [column_check(name, first.history[name], second.history[name], tolerance) for name in STRAINS]
        if iterations:
            checks.append(column_check("open_close_iterations", first.history["open_close_iterations"],
                                       second.history["open_close_iterations"], 1e-12))
        for name, unit in (("peak_stress", stress), ("youngs_modulus", stress), ("peak_strain", 1.0), ("poissons_ratio", 1.0)):
            if first.summary.get(name) is not None:
                checks.append(Check(name, first.summary[name], (second.summary.get(name) or 0.0) / unit, tolerance))
        return checks

    return judge


def column_check(name, expected, found, tolerance):
    """The largest difference of a column, relative to its largest value."""
    scale = np.max(np.abs(expected))
    at = int(np.argmax(np.abs(found - expected)))
    if scale == 0:
        return Check(name, 0.0, float(found[at]), tolerance)
    return Check(name, 1.0, 1.0 + float(found[at] - expected[at]) / scale, tolerance)


# ---- sweeps -------------------------------------------------------------------------------------------------------


def stiffness_contrast():
    """k_n d/E. With k_s = k_n the tractions of the faces are those of the uniform stress, so that cut hexagons on the free sides
    do not disturb the net: what they disturb reaches the farther the stiffer the interfaces."""
    modulus, spacing = 1e8, 0.03
    for ratio in powers(-3, 8):
        target, quick = ratio <= 1e4, ratio in (1e-3, 1.0, 1e4, 1e8)
        rounded = max(1e-6, 1e-12 * ratio)  # a gap has the round-off of the displacements, its traction k_n times that
        normal = ratio * modulus / spacing
        yield Point("k_n d/E", f"{ratio:g}", "strip of bonded hexagons", [scenes.strip(modulus, normal=normal, shear=normal)],
                    strip_moduli(modulus, 0.25, normal, normal, spacing, rounded), target, quick=quick)
        for kind in ("bond", "joint"):
            bulk, _ = scenes.moduli(modulus, 0.25, normal, 0.5 * normal, spacing, "strain")
            pressure = 1e-7 * bulk
            yield Point("k_n d/E", f"{ratio:g}", f"pressed hexagons, {'bonded' if kind == 'bond' else 'broken'}",
                        [scenes.pressed_net(modulus, normal=normal, shear=0.5 * normal, pressure=pressure, kind=kind)],
                        hydrostatic(pressure, pressure / bulk, rounded), target, quick=quick)
        normal = ratio * modulus
        yield Point("k_n d/E", f"{ratio:g}", "column with joints", [scenes.column(modulus, normal=normal, shear=0.5 * normal)],
                    axial_stiffness(scenes.column_modulus(modulus, normal)), target, quick=quick)
        yield Point("k_n d/E", f"{ratio:g}", "plane of weakness", [scenes.weak_plane(30, 1e2, 2e2, ratio)],
                    slip_load(scenes.weak_plane_strength(30, 1e2, 2e2), max(1e-5, 1e-12 * ratio)), target, quick=quick)
        scene = scenes.column(modulus, normal=normal, shear=0.5 * normal, solver={})
        yield Point("k_n d/E", f"{ratio:g}", "column with joints, default solver", [scene],
                    axial_stiffness(scenes.column_modulus(modulus, normal), 2e-2), target, quick=quick)


def rock_moduli():
    """`stiffness_ratio`: the rock's E and nu, whatever the ratio."""
    for ratio in powers(-3, 8):
        scene = scenes.strip()
        for kind in ("bond", "joint"):
            for key in ("normal_stiffness", "shear_stiffness"):
                scene["interfaces"][kind].pop(key)
            scene["interfaces"][kind] |= {"stiffness_ratio": ratio, "shear_ratio": 1}
        infinite = 1e300
        yield Point("stiffness_ratio", f"{ratio:g}", "strip of bonded hexagons", [scene],
                    strip_moduli(1e10, 0.25, infinite, infinite, 0.03), quick=ratio in (1e-3, 10.0))


def shear_contrast():
    for ratio in [*powers(-4, 1), 3.0]:
        yield Point("k_s/k_n", f"{ratio:g}", "strip of bonded hexagons", [scenes.strip(normal=1e12, shear=ratio * 1e12)],
                    strip_moduli(1e10, 0.25, 1e12, ratio * 1e12, 0.03), quick=ratio in (1e-4, 10.0))
        yield Point("k_s/k_n", f"{ratio:g}", "plane of weakness", [scenes.weak_plane(ratio=ratio)],
                    slip_load(scenes.weak_plane_strength(30, 1e5, 2e5)), quick=ratio in (1e-4, 10.0))
        yield Point("k_s/k_n", f"{ratio:g}", "pushed block", [scenes.pushed_block(30, share, ratio=ratio) for share in (0.999, 1.001)],
                    stands_and_slides, may_fall=[False, True], quick=ratio in (1e-4, 10.0))


def friction_angles():
    for angle in (0.0, 1.0, 10.0, 30.0, 45.0, 60.0, 70.0, 80.0, 85.0, 89.0, 89.9):
        target, quick = angle <= 80, angle in (0.0, 30.0, 80.0, 89.9)
        lateral = 1e6 / scenes.weak_plane_strength(angle, 0.5, 1.0)
        yield Point("friction (deg)", f"{angle:g}", "pushed block", [scenes.pushed_block(angle, share) for share in (0.999, 1.001)],
                    stands_and_slides, target, may_fall=[False, True], quick=quick)
        yield Point("friction (deg)", f"{angle:g}", "plane of weakness", [scenes.weak_plane(angle, 0.5 * lateral, lateral)],
                    slip_load(scenes.weak_plane_strength(angle, 0.5 * lateral, lateral)), target, quick=quick)
        bulk, _ = scenes.moduli(1e10, 0.25, 1e12, 5e11, 0.03, "strain")
        yield Point("friction (deg)", f"{angle:g}", "pressed hexagons, broken", [scenes.pressed_net(kind="joint", friction=angle)],
                    hydrostatic(1e3, 1e3 / bulk), target, quick=quick)
    yield Point("friction (deg)", "90", "pushed block", [scenes.pushed_block(30, 0.5) | {"interfaces": {
        "joint": scenes.fracture(1e10, 1e10, friction_angle=90)}}], stands_and_slides, quick=True)


def strengths():
    for strength in (0.0, *powers(-3, 12, 3)):
        pull, press = (scenes.bar_strength(strength, 30, strength, side) for side in (True, False))
        for name, pulled, failure in (("bar pulled", True, pull), ("bar pressed", False, press)):
            yield Point("cohesion, tension (Pa)", f"{strength:g}", name, [scenes.bar(strength, 30, strength, pulled)],
                        strength_or_elastic(pulled, failure), quick=strength in (0.0, 1e6, 1e12))
        load = scenes.weak_plane_strength(30, strength, 2e5)
        yield Point("cohesion, tension (Pa)", f"{strength:g}", "plane of weakness", [scenes.weak_plane(30, strength, 2e5)],
                    slip_load(load, max(1e-5, 10 * load / scenes.weak_plane_modulus(load))), quick=strength in (0.0, 1e6, 1e12))


def strength_or_elastic(pulled, failure):
    """The stress at the crack; a bar that is stronger than its load (strain 1e-3) stays whole and elastic."""
    modulus = scenes.column_modulus(1e9, 1e10, 2.0, 1)

    def judge(outcomes):
        cracks, last = outcomes[0].cracks, outcomes[0].last
        n_cracks = len(cracks["step"])
        if failure > 1e-3 * modulus:
            return [Check("cracks", 0.0, n_cracks, 1e-9), *axial_stiffness(modulus)(outcomes)]
        checks = [Check("cracks", 1.0, n_cracks, 1e-9)]
        if n_cracks == 1 and failure > 0:
            checks.append(Check("stress at the crack", failure, float(-cracks["p3"][0] if pulled else cracks["p1"][0]), 1e-6))
        if pulled:
            checks.append(Check("stress left, over E", 0.0, abs(last["axial_stress"]) / modulus, 1e-12))
        return checks

    return judge


def sizes():
    for ratio in powers(0, 5):
        def judge(outcomes, size=1 / ratio):
            last = outcomes[0].histories
            pressure = 2500.0 * 10.0
            return [Check("force under the small block", pressure * size**2, last["upper.normal_force"][-1], 1e-6),
                    Check("force under the large block", pressure * (1 + size**2), last["lower.normal_force"][-1], 1e-6)]

        yield Point("size ratio", f"{ratio:g}", "small block on a large one", [scenes.pile(1 / ratio)], judge, ratio <= 1e3,
                    quick=ratio in (1.0, 1e3, 1e5))
        yield Point("size ratio", f"{ratio:g}", "thin slab in a column", [scenes.slab(1 / ratio)],
                    axial_stiffness(scenes.column_modulus(1e10, 1e10, 1 + 1 / ratio, 2)), ratio <= 1e3, quick=ratio in (1.0, 1e3, 1e5))


def slivers():
    for thickness in powers(-12, -6, 2):
        yield Point("slivers", f"slab of {thickness:g}", "thin slab in a column", [scenes.slab(thickness)],
                    axial_stiffness(scenes.column_modulus(1e10, 1e10, 1 + thickness, 2)), quick=thickness == 1e-12)
    for exponent in range(1, 11):
        angle = 10.0**-exponent
        yield Point("slivers", f"angle {angle:g}", "two joints crossing, pressed", [scenes.wedge(angle, 1e4 * angle)], hydrostatic(1e4 * angle),
                    quick=exponent in (1, 3, 10))
    for shift in (0.2, 0.3):
        yield Point("slivers", f"{shift:g} d beside edges", "joint through hexagons, pressed", [scenes.sliver_net(shift)],
                    hydrostatic(1e4), quick=True)
    for exponent in range(2, 13):
        shift = 10.0**-exponent
        yield Point("slivers", f"{shift:g} d beside edges", "joint through hexagons, pressed",
                    [scenes.sliver_net(0), scenes.sliver_net(shift)], nearly_same_stresses(1e4, max(1e-6, 2 * shift)),
                    quick=exponent in (3, 12))
    for width in (1e-5, 1e-3, 1e3, 1e5):
        yield Point("slivers", f"blocks {width:g} x 1", "slab in a column", [scenes.slab(1.0, width)],
                    axial_stiffness(scenes.column_modulus(1e10, 1e10, 2, 2)), quick=width in (1e-5, 1e5))


def offsets():
    still = scenes.triaxial(exact=True)
    plain = scenes.triaxial(strain=0.004)
    for offset in powers(0, 9):
        yield Point("offset (m)", f"{offset:g}", "triaxial, all coordinates exact, through cracks",
                    [still, scenes.triaxial(exact=True, shift=(offset, -offset))], same_as_twin(tolerance=1e-9), offset <= 1e7,
                    quick=offset in (1e7, 1e9))
        yield Point("offset (m)", f"{offset:g}", "triaxial, before the first crack",
                    [plain, scenes.triaxial(strain=0.004, shift=(offset + 1 / 3, -offset - 1 / 7))],
                    same_as_twin(tolerance=1e-6, iterations=False), offset <= 1e7, quick=offset in (1e7, 1e9))


def units():
    for name, length, stress in (("mm", 1000.0, 1.0), ("km", 1e-3, 1.0), ("mm, MPa", 1000.0, 1e-6), ("cm, kPa", 100.0, 1e-3),
                                 ("E 1.5e-6", 1.0, 1e-15), ("E 1.5e-3", 1.0, 1e-12), ("E 1.5", 1.0, 1e-9), ("E 1.5e12", 1.0, 1e3),
                                 ("E 1e15", 1.0, 1e15 / 1.5e9), ("E 1.5e15", 1.0, 1e6), ("um", 1e6, 1.0), ("earth", 1e-6, 1.0),
                                 ("2^10 m", 2.0**10, 1.0), ("2^-10 m", 2.0**-10, 1.0), ("2^20 Pa", 1.0, 2.0**18), ("2^-50 Pa", 1.0, 2.0**-50),
                                 ("2^-10 m, 2^10 Pa", 2.0**-10, 2.0**10), ("2^10 m, 2^-20 Pa", 2.0**10, 2.0**-20)):
        binary = name.startswith("2^")
        for body, arguments in (("triaxial, before the first crack", {"strain": 0.004}), ("triaxial, through the first cracks", {}),
                                ("triaxial, by events", {"update": "event", "strain": 0.0055})):
            yield Point("units", name, body, [scenes.triaxial(**arguments), scenes.triaxial(length, stress, **arguments)],
                        same_as_twin(stress, 1e-9, iterations=binary), stress * 1.5e9 < 1e15,
                        quick=name in ("mm", "km", "E 1.5e-6", "2^10 m, 2^-20 Pa"), limit=40)


def steps_and_strains():
    modulus = scenes.column_modulus(1e10, 1e10)
    for strain in (*powers(-12, -1), 0.3, 0.5, 0.7, 0.9, 0.99, 1.0, 2.0):
        scene = scenes.column(poisson=0, strain=strain)
        yield Point("strain in one step", f"{strain:g}", "column with joints, pressed", [scene], axial_stiffness(modulus),
                    quick=strain in (1e-9, 0.1, 1.0, 2.0))
        scene = scenes.column(poisson=0, strain=strain, steps=20)
        yield Point("total strain in 20 steps", f"{strain:g}", "column with joints, pressed", [scene], axial_stiffness(modulus),
                    quick=strain in (1e-9, 0.1, 1.0, 2.0))
    for strain in (0.01, 0.1, 0.5, 1.0, 2.0, 10.0):
        for steps in (1, 20):
            scene = scenes.column(poisson=0, strain=-strain, steps=steps, joints=(), normal=1e10)
            yield Point("extension", f"{strain:g} in {steps}", "one block, pulled", [scene], axial_stiffness(1e10), quick=strain == 1.0)
    for steps in (1, 10, 100, 1000, 10000, 100000):
        scene = scenes.column(poisson=0, strain=1e-3, steps=steps, output=scenes.QUIET)
        yield Point("steps", f"{steps}", "column with joints, pressed", [scene], axial_stiffness(modulus), limit=20 + steps * 3e-3,
                    quick=steps in (1, 1000))
    for strain in (1e-9, 1e-6, 1e-3, 1e-2, 0.1, 0.5):
        yield Point("strain in one step", f"{strain:g}", "triaxial, one step for the platen",
                    [scenes.triaxial(strain=strain, steps=1, solver={})], whatever, quick=strain in (1e-9, 0.5), limit=120)


def whatever(outcomes):
    """No closed form: it must end in balance, or say that it has not."""
    return [Check("in balance", 1.0, float(outcomes[0].balanced), 1e-9)]


def support():
    """Held badly, or not at all, or too much."""
    yield from unheld_points()
    yield from overheld_points()
    yield from idle_points()


def unheld_points():
    square, given = scenes.square, scenes.given
    fixed = square("base", 0, -1, support="fixed")
    side = {"left": {"facing": "left"}, "right": {"facing": "right"}, "top": {"facing": "top"}, "bottom": {"facing": "bottom"}}

    def still(outcomes):
        worst_motion = max(abs(outcomes[0].histories[f"free.displacement_{axis}"][-1]) for axis in "xy")
        return [Check("motion of the free block", 0.0, worst_motion, 1e-12)]

    def lands(gap):
        fall = gap + 2500.0 * 10.0 / 1e10 + 0.25 * 2500.0 * 10.0 / 1e10  # gap, closure of the contact, half the shortening under half the weight
        return lambda outcomes: [Check("way of its middle", fall, -outcomes[0].histories["free.displacement_y"][-1], 1e-6),
                                 Check("in balance", 1.0, float(outcomes[0].balanced), 1e-9)]

    watched = scenes.QUIET | {"histories": {"free": {"block": "free"}}}
    push = {"f": {"block": "base", "point": [0.5, -0.5], "force": [0, -1]}}
    yield Point("support", "block that nothing touches, no load on it", "given blocks",
                [given([square("base", 0, -1), square("free", 3, 3)], [{"name": "rest", "forces": push}], output=watched,
                       boundaries={"bottom": {"facing": "bottom", "block": "base", "support": "fixed"}})], still, quick=True)
    for gap in (1e-6, 1e-3, 0.1):
        yield Point("support", f"block above a gap of {gap:g}, gravity", "given blocks",
                    [given([fixed, square("free", 0, gap)], [{"name": "fall"}], gravity=10, output=watched)], lands(gap), quick=True)
    yield Point("support", "block above a gap of 0.5, gravity", "given blocks",
                [given([fixed, square("free", 0, 0.5)], [{"name": "fall"}], gravity=10, output=watched)], never, quick=True,
                no_equilibrium=True)
    yield Point("support", "nothing holds it, gravity", "given blocks",
                [given([square("free", 0, 0)], [{"name": "fall"}], gravity=10)], never, quick=True, no_equilibrium=True)
    yield Point("support", "nothing holds it, pressure all around", "given blocks",
                [given([square("free", 0, 0)], [{"name": "p", "pressure": {s: 1e5 for s in side}}], boundaries=side, output=scenes.FIELDS)],
                hydrostatic(1e5), quick=True)
    yield Point("support", "nothing holds it, pressure on one side", "given blocks",
                [given([square("free", 0, 0)], [{"name": "p", "pressure": {"left": 1e5}}], boundaries=side)], never, quick=True, no_equilibrium=True)
    yield Point("support", "block without friction on a slope", "given blocks",
                [given([fixed, square("free", 0, 0)], [{"name": "tilt"}], gravity=[1, -10], friction=0)], never, quick=True, no_equilibrium=True)
    yield Point("support", "stack without friction, pushed at its middle", "given blocks",
                [given([fixed, square("a", 0, 0), square("b", 0, 1), square("c", 0, 2)],
                       [{"name": "weight"}, {"name": "push", "forces": {"f": {"block": "b", "point": [0, 1.5], "force": [1e3, 0]}}}],
                       gravity=10, friction=0)], never, quick=True, no_equilibrium=True)
    yield Point("support", "column that overturns", "given blocks",
                [given([fixed, {"name": "free", "polygon": [[0, 0], [0.1, 0], [0.1, 2], [0, 2]]}], [{"name": "tilt", "steps": 4}],
                       gravity=[1, -10], friction=60)], never, quick=True, no_equilibrium=True)


def never(outcomes):
    """There is no equilibrium: `done` in balance is wrong."""
    return [Check("equilibria found", 0.0, float(outcomes[0].balanced), 1e-9)]


def overheld_points():
    square, given = scenes.square, scenes.given
    domain = {"domain": {"rectangle": {"width": 1, "height": 1}}}

    def one_block(stages, support, poisson=0.25, **more):
        return scenes.body({}, scenes.rock(1e10, poisson), domain, stages, boundaries=support, **more)

    all_fixed = {side: {"support": "fixed"} for side in ("left", "right", "top", "bottom")}
    yield Point("support", "all sides fixed, pressure on one", "one block",
                [one_block([{"name": "p", "pressure": {"top": 1e5}}], all_fixed)],
                lambda o: [Check("strain", 0.0, abs(o[0].last["axial_strain"]), 1e-12)], quick=True)
    yield Point("support", "all sides fixed, platen on one", "one block",
                [one_block([{"name": "p", "strain": {"boundary": "top", "value": 1e-3}}], all_fixed)], never, quick=True, no_equilibrium=True)
    smooth = {side: {"support": "smooth"} for side in ("left", "right", "bottom")}
    yield Point("support", "smooth sides, platen", "one block",
                [one_block([{"name": "p", "strain": {"boundary": "top", "value": 1e-6}}], smooth, plane="strain")],
                axial_stiffness(1e10 * 0.75 / (1.25 * 0.5)), quick=True)
    pinned = {side: {"support": "pinned"} for side in ("left", "right", "bottom")}
    yield Point("support", "pinned on three sides, platen", "one block",
                [one_block([{"name": "p", "strain": {"boundary": "top", "value": 1e-6}}], pinned, plane="strain")],
                axial_stiffness(1e10 * 0.75 / (1.25 * 0.5)), quick=True)
    yield Point("support", "every block fixed", "given blocks",
                [given([square("a", 0, 0, support="fixed")], [{"name": "p"}], gravity=10)],
                lambda o: [Check("strain", 0.0, abs(o[0].last["axial_strain"]), 1e-12)], quick=True)
    fixed = square("a", 0, 0, support="fixed")
    yield Point("support", "fixed block between platens", "given blocks",
                [given([fixed], [{"name": "p", "displacement": {"boundary": "top", "value": 0.001}}])], never, quick=True, no_equilibrium=True)


def idle_points():
    still = [("axial_strain", 0.0), ("axial_stress", 0.0), ("lateral_strain", 0.0)]

    def rests(outcomes):
        return [Check(name, value, abs(outcomes[0].last[name]), 1e-12) for name, value in still]

    for name, joints in (("one block", ()), ("column with joints", (0.5,))):
        yield Point("zero load", "strain 0", name, [scenes.column(strain=0.0, joints=joints)], rests, quick=True)
        scene = scenes.column(joints=joints)
        scene["stages"] = [{"name": "nothing"}]
        yield Point("zero load", "no load", name, [scene], rests, quick=True)
        scene = scenes.column(joints=joints)
        scene["stages"] = [{"name": "p", "pressure": {"left": 0, "right": 0}}]
        yield Point("zero load", "pressure 0", name, [scene], rests, quick=True)
        scene = scenes.column(joints=joints)
        scene["stages"] = [{"name": "p", "stress": {"boundary": "top", "value": 0}, "steps": 3}]
        yield Point("zero load", "stress 0", name, [scene], rests, quick=True)
    scene = scenes.triaxial()
    scene["stages"] = [{"name": "p", "pressure": {"left": 0}}, {"name": "q", "strain": {"boundary": "top", "value": 0}}]
    yield Point("zero load", "strain 0", "triaxial", [scene], rests, quick=True)
    for strain in (1e-9, 1e-6, 1e-3, 0.1, 0.5):
        yield Point("tension", f"strain {strain:g}", "column with joints, pulled apart", [scenes.column(strain=-strain, steps=4)],
                    lambda o: [Check("stress over E", 0.0, abs(o[0].last["axial_stress"]) / 1e10, 1e-9)], quick=strain in (1e-3, 0.5))
    scene = scenes.column(steps=2)
    scene["stages"] = [{"name": "pull", "stress": {"boundary": "top", "value": -1e4}, "steps": 2}]
    yield Point("tension", "stress -10 kPa", "column with joints, pulled apart", [scene], never, quick=True, no_equilibrium=True)
    scene = scenes.bar(1e6, 30, 1e5, True)
    scene["stages"] = [{"name": "pull", "stress": {"boundary": "top", "value": -2e5}, "steps": 4}]
    yield Point("tension", "stress twice the strength", "bar with a potential crack", [scene], never, quick=True, no_equilibrium=True)
    for strain in (0.001, 0.01, 0.1):
        scene = scenes.triaxial(strain=-strain, steps=8, solver={})
        yield Point("tension", f"strain {strain:g}", "triaxial, pulled apart", [scene], whatever, limit=120, quick=strain == 0.001)


def counts():
    yield Point("blocks", "1", "one block, pressed", [scenes.column(joints=())], axial_stiffness(1e10), quick=True)
    for columns, limit, quick in ((10, 20, True), (70, 60, False), (220, 200, False), (441, 900, False)):
        bulk, _ = scenes.moduli(1e10, 0.25, 1e12, 5e11, 0.03, "strain")
        scene = scenes.pressed_net(columns=columns, rows=2 * round(columns / 1.7320508))
        scene["output"] = scenes.FIELDS
        yield Point("blocks", f"{columns * (2 * round(columns / 1.7320508) + 1)}", "pressed hexagons, bonded", [scene],
                    hydrostatic(1e3, 1e3 / bulk, 1e-5), limit=limit, quick=quick)


SWEEPS = (stiffness_contrast, rock_moduli, shear_contrast, friction_angles, strengths, sizes, slivers, offsets, units,
          steps_and_strains, support, counts)


def all_points():
    return [point for sweep in SWEEPS for point in sweep()]
