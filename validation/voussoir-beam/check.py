"""Thrust, sag and snap-through of a beam of two voussoirs on elastic joints."""

import math

import numpy as np

from suite import figures
from suite.case import order_of_convergence

THICKNESS, DENSITY, STIFFNESS = 1.0, 2500.0, 1e10
SUM = 1 + 1 / math.sqrt(2)


def gravity_at(sag, half_span):
    """g that the beam bears at the sag (of its middle, in m)."""
    share = sag / (2 * THICKNESS)
    scale = 2 * STIFFNESS * THICKNESS**4 / (3 * SUM**2 * half_span**2)
    return scale * share * (1 - share)**2 * (2 - 5 * share) / (DENSITY * half_span * THICKNESS)


def thrust_at(sag, half_span):
    """H at the sag, N/m."""
    turn = sag / half_span
    return STIFFNESS * THICKNESS**2 * turn * (1 - sag / (2 * THICKNESS))**2 / (2 * SUM**2)


def limit(half_span):
    """(sag, g) at which it snaps through: f = x (1 - x)^2 (2 - 5 x) is largest where 2 - 16 x + 20 x^2 = 0."""
    share = (16 - math.sqrt(256 - 160)) / 40
    return 2 * THICKNESS * share, gravity_at(2 * THICKNESS * share, half_span)


def run_with(case, pieces, half_span, defaults=False):
    heights = [i * THICKNESS / pieces for i in range(pieces + 1)]
    blocks = [{"name": name, "polygon": [[x, y] for y in heights] + [[x - half_span, y] for y in reversed(heights)]}
              for name, x in (("left", half_span), ("right", 2 * half_span))]
    ends = [{"name": name, "polygon": [[x, -1], [x, 2], [y, 2], [y, -1]], "support": "fixed"}
            for name, x, y in (("abutment", 0, -1), ("far_abutment", 2 * half_span, 2 * half_span + 1))]
    expected = limit(half_span)[1]
    run = case.run(f"pieces-{pieces}-span-{half_span:g}", {
        "geometry.blocks": ends + blocks, "stages.0.gravity": 0.96 * expected, "stages.1.gravity": 1.04 * expected,
        "stages.1.steps": 80, "output.fields": False}, may_fail=True, defaults=defaults)
    histories = run.histories
    ends = np.array([0.0, 0.96, 1.04]) * expected
    stage = histories["stage"].astype(int)
    gravity = ends[stage] + (ends[stage + 1] - ends[stage]) * histories["load_factor"]
    rest = run.history["balanced"] == 1
    stands = run.summary["status"] == "done"  # to the end: no limit found
    step = (ends[2] - ends[1]) / 80
    rows = slice(1, int(rest.sum()))
    sag = -half_span * np.sin(histories["left.rotation"][rows])
    return {"g": gravity[rows], "sag": sag, "thrust": histories["crown.normal_force"][rows],
            "limit": math.nan if stands else gravity[rest][-1] + 0.5 * step}


def check(case):
    half_span, pieces = 20.0, 32
    fine = run_with(case, pieces, half_span)
    before = fine["g"] < 0.97 * limit(half_span)[1]
    case.expect(f"g at which it snaps through, L/t = 20, {pieces} pieces", limit(half_span)[1], fine["limit"], 5e-3, "m/s2", digits=5)
    case.expect_worst("g at the sag found, up to 97 %", gravity_at(fine["sag"], half_span)[before], fine["g"][before], 5e-3, "m/s2", digits=5)
    case.expect_worst("thrust at the sag found", thrust_at(fine["sag"], half_span) / 1e3, fine["thrust"] / 1e3, 5e-3, "kN/m", digits=5)
    by_default = run_with(case, pieces, half_span, True)
    case.expect_default(f"g at which it snaps through, {pieces} pieces", limit(half_span)[1], by_default["limit"], "m/s2")
    counts = np.array([2, 4, 8])
    coarse = [run_with(case, n, half_span)["limit"] for n in counts]
    spans = np.array([5.0, 10.0])
    shorter = [run_with(case, pieces, span)["limit"] / limit(span)[1] for span in spans]
    draw(case, fine, half_span, counts, np.array(coarse) / limit(half_span)[1], np.append(spans, half_span),
         np.append(shorter, fine["limit"] / limit(half_span)[1]))


def draw(case, fine, half_span, counts, coarse, spans, shorter):
    figure, (sketch, plot, error) = case.figure(10.5, 3.2, plots=2, ratios=[0.9, 1, 0.9])
    turn = 0.16
    for side in (-1, 1):
        block = [(-4, 0), (0, 0), (0, 1), (-4, 1)]
        moved = [(-(4 + x) * math.cos(turn) - y * math.sin(turn) + 4.0, y * math.cos(turn) - (4 + x) * math.sin(turn)) for x, y in block]
        figures.block(sketch, [(side * x, y) for x, y in moved])
        figures.block(sketch, [(side * 4, -0.9), (side * 4.6, -0.9), (side * 4.6, 1.6), (side * 4, 1.6)])
    figures.arrow(sketch, (-4.9, 0.2), (-4.0, 0.2), "H", (-0.1, 0.3))
    figures.arrow(sketch, (4.9, 0.2), (4.0, 0.2), "H", (0.1, 0.3))
    figures.arrow(sketch, (-2, 1.3), (-2, 0.3), "W", (0.3, 0.3))
    figures.label(sketch, (2.0, -0.9), "L")
    sag = np.linspace(0, 0.6, 200)
    plot.plot(sag, gravity_at(sag, half_span), color=figures.INK, linewidth=1.0, label="theory")
    plot.plot(fine["sag"][::2], fine["g"][::2], "o", color=figures.FOUND, label="run")
    plot.plot(*limit(half_span), "+", markersize=11, color=figures.SECOND, label="snap-through")
    plot.set(xlabel="sag of the middle over t", ylabel="g (m/s$^2$)", ylim=(0, None))
    plot.legend(loc="lower right")
    by_count, by_span = np.abs(coarse - 1), np.abs(shorter - 1)
    error.loglog(1 / counts, by_count, "o-", color=figures.FOUND, label=f"over 1/pieces, order {order_of_convergence(1 / counts, by_count):.1f}")
    error.loglog(1 / spans, by_span, "s-", color=figures.SECOND, label=f"over t/L, order {order_of_convergence(1 / spans, by_span):.1f}")
    error.axhline(5e-3, color=figures.PALE, linestyle="--", linewidth=0.9)
    error.set(xlabel="1/pieces, t/L", ylabel="error of the limit")
    error.legend()
    case.save_figure(figure)
