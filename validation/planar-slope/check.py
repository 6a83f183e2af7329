"""Factor of safety of a planar slope by reduced strengths."""

import math

import numpy as np

from suite import figures

HEIGHT, COHESION, FRICTION = 10.0, 20e3, math.tan(math.radians(30))
WEIGHT = 0.5 * HEIGHT**2 * 2500 * 10  # N/m, above a plane at 45 degrees
LENGTH = HEIGHT * math.sqrt(2)
DRIVING = NORMAL = WEIGHT / math.sqrt(2)
PEAK = 2 * NORMAL / LENGTH  # pressure at the toe: the weight acts at a third of the plane, the pressure is a triangle


def factor(lost=0.0):
    """Factor of safety where this share of the cohesion is lost."""
    return (COHESION * LENGTH * (1 - lost) + NORMAL * FRICTION) / DRIVING


def run_with(case, name, pieces, onset=20.0, defaults=False):
    """With the plane cut in equal pieces."""
    corners = [HEIGHT * i / pieces for i in range(1, pieces)]
    block = {"name": "slope", "polygon": [[0, 0]] + [[x, x] for x in corners] + [[HEIGHT, HEIGHT], [0, HEIGHT]]}
    settings = {} if defaults else {"interfaces.plane.cohesion_onset": onset}
    return case.run(name, {"geometry.blocks.1": block, "output.fields": False, **settings}, defaults=defaults)


def check(case):
    pieces = [1, 2, 5, 16]
    runs = [run_with(case, f"pieces-{n}", n) for n in pieces]
    found = [run.summary["factor_of_safety"] for run in runs]
    for n, factor_found in zip(pieces, found):
        case.expect(f"factor of safety, plane in {n} piece{'s' if n > 1 else ''}", factor(), factor_found, 1e-4)
    history = runs[0].histories
    case.expect_worst("normal force on the plane, all steps", NORMAL / 1e3, history["plane.normal_force"][1:] / 1e3, 1e-6, "kN/m")
    case.expect_worst("shear force on the plane, all steps", DRIVING / 1e3, history["plane.shear_force"][1:] / 1e3, 1e-6, "kN/m")
    onsets = PEAK / np.array([128, 32, 8, 4])
    of_onset = [run_with(case, f"onset-{onset:.0f}", 1, onset).summary["factor_of_safety"] for onset in onsets]
    case.expect_worst("with a cohesion onset of up to a quarter of the pressure at the toe", factor(0.5 * onsets / PEAK), of_onset, 1e-4)
    by_default = [run_with(case, f"pieces-{n}", n, defaults=True).summary["factor_of_safety"] for n in pieces]
    case.expect_default("factor of safety, plane in 1 to 16 pieces", factor(), by_default)
    draw(case, pieces, found, by_default, onsets, of_onset)


def draw(case, pieces, found, by_default, onsets, of_onset):
    figure, (sketch, plot) = case.figure()
    figures.block(sketch, [(-3, -2.5), (13, -2.5), (13, 10), (10, 10), (0, 0), (-3, 0)])
    figures.block(sketch, [(0, 0), (10, 10), (0, 10)], facecolor="#efe9df")
    figures.ground(sketch, (-3, -2.5), (13, -2.5), 0.8)
    figures.arrow(sketch, (10 / 3, 20 / 3), (10 / 3, 4), "W", (0.8, 0.3))
    figures.line(sketch, [(0, 0), (0.5 * 4, -0.5 * 4), (10, 10)], color=figures.SECOND)
    figures.label(sketch, (4.2, 1.7), "p", color=figures.SECOND)
    figures.arrow(sketch, (-1.5, 0), (-1.5, 10), "H", (-0.8, 0), figures.INK, "<|-|>")
    share = np.linspace(0, 0.27, 50)
    plot.plot(share, [factor(0.5 * x) for x in share], color=figures.INK, linewidth=1.0, label="theory, less $c L t_r/(2 p_0)$")
    plot.plot(onsets / PEAK, of_onset, "o", color=figures.FOUND, label="one piece")
    plot.plot([20 / PEAK] * len(pieces), found, "s", markersize=8, markerfacecolor="none", color=figures.SECOND, label="1, 2, 5, 16 pieces")
    plot.plot([0.01 * COHESION / PEAK] * len(pieces), by_default, "+", markersize=9, color=figures.THIRD, label="the same, defaults")
    plot.set(xlabel="onset of the cohesion over the pressure at the toe", ylabel="factor of safety")
    plot.legend(loc="lower left")
    case.save_figure(figure)
