"""Jointed slopes: strength reduction with several numbers of steps, plain runs and the explicit integrator."""

import math

import yaml

HEIGHT, UNIT_WEIGHT, FRICTION, COHESION = 20.0, 26e3, "friction_angle", "cohesion"
# face, beds' dip, spacing, offset (along their normal), spacing and offset of the upright joints, c, phi, height
BEDS = {"scene": (70, 35, 2.5, 0.3, 2.9, 0.4, 16e3, 32, 8.0), "a1": (70, 35, 2.3, 0.3, 2.9, 1.3, 40e3, 32, 20.0)}
STEPS = {"scene": (5, 10, 20, 40), "a1": (10,), "b2": (10,), "c2": (10, 20)}


def theory(face, dip, spacing, offset, width, first, cohesion, friction, height):
    """Smallest factor over all beds that daylight and all upright joints behind the face."""
    slope, psi, mu = math.tan(math.radians(face)), math.radians(dip), math.tan(math.radians(friction))
    best, n = math.inf, 4000
    for k in range(100):
        toe = (offset + k * spacing) / math.cos(psi)
        start, end = toe / (slope - math.tan(psi)), (height - toe) / math.tan(psi)
        if start * slope >= height:
            break
        joints = [-first + j * width for j in range(100)]
        for back in [x for x in joints if start < x < end] + [end]:
            dx = (back - start) / n
            xs = [start + (i + 0.5) * dx for i in range(n)]
            weight = UNIT_WEIGHT * dx * sum(max(0.0, min(height, x * slope) - x * math.tan(psi) - toe) for x in xs)
            length = (back - start) / math.cos(psi)
            best = min(best, (cohesion * length + weight * math.cos(psi) * mu) / (weight * math.sin(psi)))
    return best


def weaker(case, scene, factor):
    """The strengths of all interfaces divided by a factor."""
    content = yaml.safe_load((case.directory / f"{scene}.yaml").read_text(encoding="utf-8"))
    values = {"stages": [{"name": "weight"}], "output.fields": False}
    for name, law in content["interfaces"].items():
        values[f"interfaces.{name}.{FRICTION}"] = math.degrees(math.atan(math.tan(math.radians(law[FRICTION])) / factor))
        values[f"interfaces.{name}.{COHESION}"] = law[COHESION] / factor
    return values


def stands(case, scene, factor, integrator):
    values = {**weaker(case, scene, factor), "analysis.integrator": integrator}
    return case.run(f"{scene}-{integrator}-{factor:.5f}", values, scene=f"{scene}.yaml", may_fail=True).exit_code == 0


def reduced(case, scene, steps, start=0.5):
    values = {"stages.1.steps": steps, "stages.1.strength_reduction.to": 2.5, "stages.1.strength_reduction.from": start, "output.fields": False}
    found = case.run(f"{scene}-steps-{steps}", values, scene=f"{scene}.yaml", may_fail=True).summary["factor_of_safety"]
    return math.nan if found is None else found


def check(case):
    expected = {name: theory(*values) for name, values in BEDS.items()}
    expected["b2"] = math.tan(math.radians(50)) / math.tan(math.radians(38))
    for scene, factor in expected.items():
        found = [reduced(case, scene, n) for n in STEPS[scene]]
        case.expect_worst(f"{scene}: factor of safety", factor, found, 0.02)
        for integrator in ("implicit", "explicit"):
            verdicts = [stands(case, scene, factor * (1 + share), integrator) for share in (-0.02, 0.02)]
            case.expect_same(f"{scene}: stands 2 % below, falls 2 % above, {integrator}", [True, False], verdicts)
    found = [reduced(case, "c2", n) for n in STEPS["c2"]]  # no closed form: the explicit integrator is the reference
    case.expect("c2: largest over smallest factor, 10 and 20 steps", 1.0, max(found) / min(found), 0.02)
    verdicts = [stands(case, "c2", factor, "explicit") for factor in (min(found) * 0.98, max(found) * 1.02)]
    case.expect_same("c2: explicit stands 2 % below, falls 2 % above", [True, False], verdicts)
