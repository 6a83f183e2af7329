"""A roof wedge between abutments that a given force pushes together."""

import importlib.util
import math
from pathlib import Path

from suite import figures

SPEC = importlib.util.spec_from_file_location("roof_wedge_poses", Path(__file__).with_name("wedge.py"))
wedge = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(wedge)

SIZES = (1, 10, 100, 1000)
POSES = [(f"ratio-{n}", {"ratio": n}) for n in SIZES]
POSES += [(f"both-{n}", {"ratio": n, "both": True}) for n in SIZES]
POSES += [(f"neighbour-{n}", {"neighbour": n}) for n in SIZES]
POSES += [(f"turn-{t}", {"ratio": 10, "turn": t}) for t in (17, 45, 90, 133, 180)]
POSES += [(f"force-{n}", {"ratio": n, "turn": 33, "neighbour": 10 * n, "point": True}) for n in (1, 10)]
STRENGTHS = [(40, 0.0), (30, 40e3), (25, 70e3), (20, 90e3), (0, 165e3)]  # friction in degrees, cohesion
MARKS = ("o", "s", "^", "D", "v")


def law(friction, cohesion, factor=1.0):
    return {"interfaces.joint.friction_angle": math.degrees(math.atan(math.tan(math.radians(friction)) / factor)),
            "interfaces.joint.cohesion": cohesion / factor}


def safety(case, name, friction, cohesion, **pose):
    values = wedge.overrides(**pose)
    values["stages"] += [{"name": "strength", "strength_reduction": {"from": 1, "to": 2}, "steps": 10}]
    found = case.run(name, {**values, **law(friction, cohesion), "output.fields": False}, may_fail=True).summary["factor_of_safety"]
    return math.nan if found is None else found


def stands(case, name, friction, cohesion, share, **pose):
    factor = wedge.safety(friction, cohesion) * (1 + share)
    values = {**wedge.overrides(**pose), **law(friction, cohesion, factor), "output.fields": False}
    return case.run(name, values, may_fail=True).exit_code == 0


def check(case):
    found = [safety(case, name, 40, 0.0, **pose) for name, pose in POSES]
    case.expect_worst("factor of safety, friction, all sizes and turns", wedge.safety(40), found, 1e-3)
    wrong = [(name, share) for name, pose in POSES for share in (-3e-3, 3e-3)
             if stands(case, f"plain-{name}-{share:g}", 40, 0.0, share, **pose) != (share < 0)]
    case.expect_same("wrong verdicts 0.3 % below and above the limit, friction", [], wrong)
    by_strength = {(40, 0.0): found[:len(SIZES)]}
    for friction, cohesion in STRENGTHS[1:]:
        text = f"phi {friction}, c {cohesion / 1e3:g} kPa"
        found = [safety(case, f"phi-{friction}-ratio-{n}", friction, cohesion, ratio=n) for n in SIZES]
        case.expect_worst(f"factor of safety, {text}, all sizes", wedge.safety(friction, cohesion), found, 1e-3)
        wrong = [(n, share) for n in SIZES for share in (-3e-3, 3e-3)
                 if stands(case, f"plain-phi-{friction}-ratio-{n}-{share:g}", friction, cohesion, share, ratio=n) != (share < 0)]
        case.expect_same(f"wrong verdicts 0.3 % below and above the limit, {text}", [], wrong)
        by_strength[friction, cohesion] = found
    ratios = (1, 2, 5, 10)
    bray = [case.run(f"bray-{ratio}", {"interfaces.joint.shear_stiffness": 20e9 / ratio, "materials.rock.density": wedge.bray_density()},
                     scene="bray.yaml").summary["factor_of_safety"] for ratio in ratios]
    case.expect_worst("factor of safety under relaxing stress (Bray), k_n/k_s 1 to 10", [wedge.bray(r) for r in ratios], bray, 1e-3)
    draw(case, by_strength, ratios, bray)


def draw(case, by_strength, ratios, bray):
    figure, (sketch, plot, relaxing) = case.figure(9.6, plots=2)
    half, base = wedge.TOP, wedge.BASE
    right = [(base, 0), (base + 2.5, 0), (base + 2.5, 4), (half, 4)]
    figures.block(sketch, [(-x, y) for x, y in right])
    figures.block(sketch, right)
    figures.block(sketch, [(-base, 0), (base, 0), (half, 4), (-half, 4)], facecolor="#efe9df")
    figures.ground(sketch, (-base - 2.5, 4), (-base - 2.5, 0), 0.4)
    figures.smooth_support(sketch, (base, 0), (base + 2.5, 0), 0.35)
    figures.smooth_support(sketch, (base + 2.5, 4), (half, 4), 0.35)
    figures.arrow(sketch, (base + 4, 2), (base + 2.5, 2), "H", (0.2, 0.4))
    figures.arrow(sketch, (0, 2.6), (0, 0.8), "W", (0.5, 0))
    for marker, ((friction, cohesion), found) in zip(MARKS, by_strength.items()):
        line = plot.plot(SIZES, found, marker, linestyle="none", label=rf"$\varphi$ {friction}$^\circ$, c {cohesion / 1e3:g} kPa")
        plot.axhline(wedge.safety(friction, cohesion), color=line[0].get_color(), linewidth=1.0)
    plot.set(xscale="log", xlabel="size of the abutments over the wedge's", ylabel="factor of safety", ylim=(1.05, 1.6))
    plot.legend(loc="upper left", ncols=2, fontsize=7)
    relaxing.plot(ratios, [wedge.bray(r) for r in ratios], color=figures.INK, linewidth=1.0, label="Bray")
    relaxing.plot(ratios, bray, "o", color=figures.FOUND, label="found")
    relaxing.set(xlabel="$k_n/k_s$")
    relaxing.legend()
    case.save_figure(figure)
