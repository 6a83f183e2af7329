"""The slope at which a block slides, and its contact forces below that slope."""

import math

import numpy as np

from suite import figures
from suite.case import bisect

FRICTION = 30.0
WEIGHT = 4.0 * 1.0 * 2500 * 10  # N/m


def run_at(case, slope, defaults=False):
    angle = math.radians(slope)
    return case.run(f"slope-{slope:.5f}", {"analysis.gravity": [10 * math.sin(angle), -10 * math.cos(angle)]}, may_fail=True,
                    defaults=defaults)


def forces(run):
    """Normal and shear force on the base over the weight."""
    faces = run.interfaces()
    length = faces.lengths()
    return -(faces["normal_traction"] * length).sum() / WEIGHT, abs((faces["shear_traction"] * length).sum()) / WEIGHT


def check(case):
    slopes = [0, 5, 10, 15, 20, 25, 29, 29.99]
    found = []
    for slope in slopes:
        run = run_at(case, slope)
        if not run.balanced:
            case.expect_same(f"in equilibrium at {slope} deg", True, False)
        found.append(forces(run))
    radians = np.radians(slopes)
    case.expect_worst("N/W = cos, up to 29.99 deg", np.cos(radians), [n for n, _ in found], 1e-6)
    case.expect_worst("T/W = sin, up to 29.99 deg", np.sin(radians), [t for _, t in found], 1e-6, absolute=True)
    low, high = bisect(lambda slope: run_at(case, slope).balanced, 29.0, 31.0, 0.002)
    case.expect("slope at which it slides", FRICTION, 0.5 * (low + high), 0.01, "deg", absolute=True)
    sliding = {slope: run_at(case, slope) for slope in (30.01, 35, 40, 45)}
    case.expect_same("in equilibrium at 30.01, 35, 40, 45 deg", [False] * 4, [run.balanced for run in sliding.values()])
    by_default = bisect(lambda slope: run_at(case, slope, True).balanced, 29.0, 31.0, 0.002)
    case.expect_default("slope at which it slides: tangent", math.tan(math.radians(FRICTION)), math.tan(math.radians(0.5 * sum(by_default))))
    draw(case, slopes, found, 0.5 * (low + high), sliding)


def draw(case, slopes, found, limit, sliding):
    figure, (sketch, plot) = case.figure()
    angle = math.radians(25)
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])

    def at(*points):
        return [turn @ np.array(point) for point in points]

    figures.block(sketch, at((-1, -0.8), (6, -0.8), (6, 0), (-1, 0)))
    figures.block(sketch, at((0, 0), (4, 0), (4, 1), (0, 1)))
    figures.ground(sketch, *at((-1, -0.8), (6, -0.8)), 0.3)
    centre = turn @ np.array([2, 0.5])
    figures.arrow(sketch, centre, centre + [0, -1.8], "W", (0.35, 0))
    figures.label(sketch, turn @ np.array([5, 0.6]), r"$\varphi$ = 30°")
    slope = np.linspace(0, 45, 300)
    radians = np.radians(slope)
    plot.plot(slope, np.cos(radians), color=figures.INK, linewidth=1.0, label="theory")
    plot.plot(slope, np.minimum(np.sin(radians), np.cos(radians) * math.tan(math.radians(FRICTION))), color=figures.INK, linewidth=1.0)
    plot.plot(slopes, [n for n, _ in found], "o", color=figures.FOUND, label="N/W, at rest")
    plot.plot(slopes, [t for _, t in found], "s", color=figures.SECOND, label="T/W, at rest")
    plot.plot(list(sliding), [0.02] * len(sliding), "x", color=figures.INK, label="no equilibrium")
    plot.axvline(limit, color=figures.PALE, linewidth=0.9, linestyle="--")
    figures.label(plot, (limit + 0.5, 0.1), f"slides at {limit:.3f}°", ha="left")
    plot.set(xlabel="slope (deg)", ylabel="force over weight", ylim=(0, 1.05))
    plot.legend()
    case.save_figure(figure)
