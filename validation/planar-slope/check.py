"""Factor of safety of a planar slope by reduced strengths."""

import math

import numpy as np

from suite import figures
from suite.case import order_of_convergence

HEIGHT, COHESION, FRICTION = 10.0, 20e3, math.tan(math.radians(30))
WEIGHT = 0.5 * HEIGHT**2 * 2500 * 10  # N/m, above a plane at 45 degrees
LENGTH = HEIGHT * math.sqrt(2)
DRIVING = NORMAL = WEIGHT / math.sqrt(2)
PEAK = 2 * NORMAL / LENGTH  # pressure at the toe: the weight acts at a third of the plane, the pressure is a triangle


def factor(lost=0.0):
    """Factor of safety where this share of the cohesion is lost."""
    return (COHESION * LENGTH * (1 - lost) + NORMAL * FRICTION) / DRIVING


def equal(n):
    return [HEIGHT * i / n for i in range(1, n)]


def halved(n):
    """Corners at 1/2, 3/4, 7/8 ... of the plane: the last piece is 2^-n of it."""
    return [HEIGHT * (1 - 0.5**i) for i in range(1, n + 1)]


def run_with(case, name, corners, onset):
    block = {"name": "slope", "polygon": [[0, 0]] + [[x, x] for x in corners] + [[HEIGHT, HEIGHT], [0, HEIGHT]]}
    return case.run(name, {"geometry.blocks.1": block, "interfaces.plane.cohesion_onset": onset, "output.fields": False})


def check(case):
    pieces = [1, 2, 4, 8, 16]
    by_equal = np.array([run_with(case, f"equal-{n}", equal(n), 20).summary["factor_of_safety"] for n in pieces])
    last = 0.5 ** np.array([2, 4, 6, 8])
    by_halves = np.array([run_with(case, f"halved-{n}", halved(n), 20).summary["factor_of_safety"] for n in (2, 4, 6, 8)])
    fine = run_with(case, "halved-12", halved(12), 20)
    case.expect("factor of safety, last piece L/4096", factor(), fine.summary["factor_of_safety"], 1e-4)
    history = fine.histories
    case.expect_worst("normal force on the plane, all steps", NORMAL / 1e3, history["plane.normal_force"][1:] / 1e3, 1e-6, "kN/m")
    case.expect_worst("shear force on the plane, all steps", DRIVING / 1e3, history["plane.shear_force"][1:] / 1e3, 1e-6, "kN/m")
    case.expect_worst("with equal pieces, less c L/(6 n)", [factor(1 / (6 * n)) for n in pieces], by_equal, 1e-4)
    for share in (32, 4):
        onset = PEAK / share
        found = run_with(case, f"onset-{share}", halved(12), onset).summary["factor_of_safety"]
        case.expect(f"cohesion onset of {onset / 1e3:.4g} kPa", factor(0.5 / share), found, 1e-4)
    draw(case, pieces, by_equal, last, by_halves, fine.summary["factor_of_safety"])


def draw(case, pieces, by_equal, last, by_halves, fine):
    figure, (sketch, plot) = case.figure()
    figures.block(sketch, [(-3, -2.5), (13, -2.5), (13, 10), (10, 10), (0, 0), (-3, 0)])
    figures.block(sketch, [(0, 0), (10, 10), (0, 10)], facecolor="#efe9df")
    figures.ground(sketch, (-3, -2.5), (13, -2.5), 0.8)
    figures.arrow(sketch, (10 / 3, 20 / 3), (10 / 3, 4), "W", (0.8, 0.3))
    figures.line(sketch, [(0, 0), (0.5 * 4, -0.5 * 4), (10, 10)], color=figures.SECOND)
    figures.label(sketch, (4.2, 1.7), "p", color=figures.SECOND)
    figures.arrow(sketch, (-1.5, 0), (-1.5, 10), "H", (-0.8, 0), figures.INK, "<|-|>")
    first = 1.0 / np.array(pieces)
    share = np.logspace(-3.8, 0, 50)
    plot.loglog(share, [1 - factor(x / 6) / factor() for x in share], color=figures.INK, linewidth=1.0, label="a sixth of the last piece without cohesion")
    plot.loglog(first, 1 - by_equal / factor(), "o", color=figures.FOUND, label=f"equal pieces, order {order_of_convergence(first, 1 - by_equal / factor()):.2f}")
    plot.loglog(last, 1 - by_halves / factor(), "s", markersize=8, markerfacecolor="none", color=figures.SECOND, label="halved towards the top")
    plot.loglog([0.5**12], [abs(1 - fine / factor())], "d", color=figures.THIRD, label=f"last piece L/4096: F = {fine:.5f}")
    plot.axhline(1e-4, color=figures.PALE, linestyle="--", linewidth=0.9)
    figures.label(plot, (3e-4, 1.4e-4), "tolerance", color=figures.PALE)
    plot.set(xlabel="uppermost piece over the plane's length", ylabel="shortfall of the factor of safety", ylim=(1e-6, 0.2))
    plot.legend(loc="upper left")
    case.save_figure(figure)
