"""Strength of a specimen with one plane of weakness at all inclinations."""

import math

import numpy as np

from suite import figures

COHESION, FRICTION, LATERAL = 0.1e6, math.radians(30), 0.2e6
HIGHEST = 2.0e6  # differential stress up to which the specimens that do not slip are pressed


def strength(beta):
    """p1 - p3 at slip; beta (degrees) between the plane's normal and the load (Jaeger 1960)."""
    beta = np.radians(beta)
    return 2 * (COHESION + LATERAL * math.tan(FRICTION)) / ((1 - math.tan(FRICTION) / np.tan(beta)) * np.sin(2 * beta))


def scene_of(beta):
    rise = math.tan(math.radians(beta))
    height = rise + 1.0
    return {"geometry.domain.rectangle.height": height,
            "geometry.fractures.0.trace": [[-0.05, 0.5 - 0.05 * rise], [1.05, 0.5 + 1.05 * rise]]}


def stiffness(run):
    """Rise of the stress in the last load step over that in the first one with a platen."""
    rise = np.diff(run.history["differential_stress"][run.history["stage"] == 1])
    return abs(rise[-1] / rise[0])


def check(case):
    angles = [35, 40, 45, 50, 55, 60, 65, 70, 75, 80]
    found, curves = [], {}
    for beta in angles:
        run = case.run(f"beta-{beta}", scene_of(beta))
        found.append(run.history["differential_stress"][-1])
        curves[beta] = run.history
        still_rising = stiffness(run) > 1e-3
        case.expect_same(f"beta {beta} deg: slips, in balance", (True, True), (bool(not still_rising), run.balanced))
    for beta in (40, 50, 60, 70, 80):
        case.expect(f"p1 - p3 at slip, beta {beta} deg", strength(beta) / 1e6, found[angles.index(beta)] / 1e6, 1e-5, "MPa")
    case.expect_worst("p1 - p3 at slip, all", strength(np.array(angles)) / 1e6, np.array(found) / 1e6, 1e-5, "MPa")
    by_default = [case.run(f"beta-{beta}", scene_of(beta), defaults=True).history["differential_stress"][-1] for beta in angles]
    case.expect_default("p1 - p3 at slip, all", strength(np.array(angles)) / 1e6, np.array(by_default) / 1e6, "MPa")
    for beta in (0, 10, 20, 30):
        run = case.run(f"beta-{beta}", scene_of(beta))
        loaded = run.history["differential_stress"][-1] > HIGHEST
        case.expect_same(f"beta {beta} deg: slips up to {HIGHEST / 1e6:g} MPa", (False, True),
                         (bool(stiffness(run) < 0.999), bool(loaded)))
    draw(case, angles, found)


def draw(case, angles, found):
    figure, (sketch, plot) = case.figure()
    rise = math.tan(math.radians(60))
    figures.block(sketch, [(0, 0), (1, 0), (1, 0.5 + rise), (0, 0.5)])
    figures.block(sketch, [(0, 0.5), (1, 0.5 + rise), (1, 1 + rise), (0, 1 + rise)], facecolor="#efe9df")
    figures.smooth_support(sketch, (0, 0), (1, 0), 0.12)
    for x in (0.2, 0.5, 0.8):
        figures.arrow(sketch, (x, 3.3), (x, 2.8))
    for y in (0.4, 1.4, 2.4):
        figures.arrow(sketch, (-0.5, y), (-0.05, y))
        figures.arrow(sketch, (1.5, y), (1.05, y))
    figures.label(sketch, (0.5, 3.45), "$p_1$", color=figures.FOUND)
    figures.label(sketch, (-0.65, 1.4), "$p_3$", color=figures.FOUND)
    middle = np.array([0.5, 0.5 + 0.5 * rise])
    figures.arrow(sketch, middle, middle + 0.7 * np.array([-math.sin(math.pi / 3), math.cos(math.pi / 3)]), colour=figures.INK)
    figures.line(sketch, [middle, middle + [0, 0.8]], linestyle=":")
    figures.label(sketch, middle + [-0.17, 0.55], r"$\beta$")
    beta = np.linspace(30.5, 89.5, 400)
    plot.plot(beta, strength(beta) / 1e6, color=figures.INK, linewidth=1.0, label="theory")
    plot.plot(angles, np.array(found) / 1e6, "o", color=figures.FOUND, label="runs, at slip")
    plot.plot([0, 10, 20, 30], [HIGHEST / 1e6] * 4, "^", color=figures.SECOND, label="runs, pressed to 2 MPa without slip")
    plot.axvspan(0, 30, color="#f3f3f3")
    plot.set(xlabel=r"$\beta$, between the plane's normal and the load (deg)", ylabel="$p_1 - p_3$ (MPa)", xlim=(0, 90), ylim=(0, 2.6))
    plot.legend(loc="lower left")
    case.save_figure(figure)
