"""The push that overturns a block, or makes it slide, at several stiffnesses of the joint."""

import math

import numpy as np

from suite import figures
from suite.case import bisect, order_of_convergence

WIDTH, HEIGHT, ARM, STRIP = 1.0, 2.0, 1.5, 0.1
WEIGHT = WIDTH * HEIGHT * 2500 * 10  # N/m
RIGID = WEIGHT * WIDTH / (2 * ARM)


def winkler(stiffness):
    """Push on a rigid block on a continuous elastic foundation without tension.

    Turned by w it stands on a strip x = sqrt(2 W/(k_n w)) with the resultant at x/3 from the edge, and its weight has
    moved by w H/2 towards it; the largest moment is that at w = (3 H)^(-2/3) (2 W/k_n)^(1/3).
    """
    turn = (3 * HEIGHT) ** (-2 / 3) * (2 * WEIGHT / stiffness) ** (1 / 3)
    strip = math.sqrt(2 * WEIGHT / (stiffness * turn))
    return WEIGHT * (WIDTH / 2 - strip / 3 - turn * HEIGHT / 2) / ARM


def corner(stiffness):
    """The same on three points (ends and middle): the middle opens at the rotation 12 W/(k_n b^2), and from then on the
    resultant is at the edge."""
    return WEIGHT * (WIDTH / 2 - HEIGHT / 2 * 12 * WEIGHT / (stiffness * WIDTH**2)) / ARM


def limit(case, stiffness, friction, low, high, defaults=False):
    """The push (N/m) between a run that finds equilibrium and one that does not."""

    def stands(share):
        run = case.run(f"k-{stiffness:g}-phi-{friction:g}-{share:.6f}", {
            "interfaces.joint.normal_stiffness": stiffness, "interfaces.joint.shear_stiffness": stiffness,
            "interfaces.joint.friction_angle": friction, "stages.1.pressure.push": share * RIGID / STRIP,
            "output.fields": False}, may_fail=True, defaults=defaults)
        return run.balanced

    low, high = bisect(stands, low, high, 2e-5)
    return 0.5 * (low + high) * RIGID


def check(case):
    stiffnesses = np.array([1e8, 3e8, 1e9, 1e10])
    pushes = np.array([limit(case, k, 45.0, 0.95, 1.01) for k in stiffnesses])
    case.expect(f"push that overturns, k_n {stiffnesses[-1]:g} Pa/m", RIGID / 1e3, pushes[-1] / 1e3, 5e-3, "kN/m", digits=6)
    case.expect("the same beside the hinge of three points, k_n 1e+08 Pa/m", corner(1e8) / 1e3, pushes[0] / 1e3, 5e-3, "kN/m", digits=6)
    friction = 15.0  # tan 15 deg < b/(2a)
    sliding = limit(case, 1e10, friction, 0.7, 0.9)
    case.expect("push that slides it, phi 15 deg", WEIGHT * math.tan(math.radians(friction)) / 1e3, sliding / 1e3, 5e-3, "kN/m", digits=6)
    by_default = [limit(case, 1e10, 45.0, 0.95, 1.01, True), limit(case, 1e10, friction, 0.7, 0.9, True)]
    case.expect_default("pushes that overturn and slide it", [RIGID / 1e3, WEIGHT * math.tan(math.radians(friction)) / 1e3],
                        np.array(by_default) / 1e3, "kN/m")
    draw(case, stiffnesses, pushes)


def draw(case, stiffnesses, pushes):
    figure, (sketch, plot) = case.figure()
    figures.block(sketch, [(-0.7, -0.5), (2, -0.5), (2, 0), (-0.7, 0)])
    figures.block(sketch, [(0, 0), (1, 0), (1, 2), (0, 2)])
    figures.ground(sketch, (-0.7, -0.5), (2, -0.5), 0.12)
    figures.arrow(sketch, (-0.7, 1.5), (0, 1.5), "P", (0, 0.17))
    figures.arrow(sketch, (0.5, 1.0), (0.5, 0.3), "W", (0.17, 0))
    figures.arrow(sketch, (1.3, 0), (1.3, 1.5), "a", (0.15, 0), figures.INK, "<|-|>")
    figures.arrow(sketch, (0, 2.2), (1, 2.2), "b", (0, 0.15), figures.INK, "<|-|>")
    error = 1 - pushes / RIGID
    shown = error > 4e-5  # the bisection's width is 2e-5
    order = -order_of_convergence(stiffnesses[shown], error[shown]) if shown.sum() > 1 else math.nan
    k = np.logspace(7.8, 13, 100)
    plot.loglog(k, 1 - np.array([winkler(value) for value in k]) / RIGID, color=figures.INK, linewidth=1.0, label="continuous foundation, order 1/3")
    plot.loglog(k, 1 - np.array([corner(value) for value in k]) / RIGID, "--", color=figures.INK, linewidth=1.0, label="three points, order 1")
    plot.loglog(stiffnesses[shown], error[shown], "o", color=figures.FOUND, label=f"runs, order {order:.2f}")
    plot.axhline(5e-3, color=figures.PALE, linestyle="--", linewidth=0.9)
    figures.label(plot, (2e8, 6.2e-3), "tolerance", color=figures.PALE)
    plot.set(xlabel="$k_n$ (Pa/m)", ylabel="1 - P / (W b / 2a)", ylim=(3e-5, 1))
    plot.legend()
    case.save_figure(figure)
