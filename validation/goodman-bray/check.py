"""Toppling of blocks on a stepped base against limit equilibrium."""

import math

import numpy as np

from suite import figures
from suite.case import order_of_convergence

ALPHA = math.radians(30)  # of the bases
WIDTH, STEP, GAMMA = 10.0, 1.0, 25e3
HEIGHTS = [4.0 * n for n in range(1, 11)] + [34.0, 28.0, 22.0, 16.0, 10.0, 4.0]
WEIGHTS = [GAMMA * WIDTH * height for height in HEIGHTS]
PUBLISHED = {12: 292.5, 11: 825.7, 10: 1556.0, 9: 2826.7, 8: 3922.0, 7: 4595.0, 6: 4837.0, 5: 4637.0, 4: 3978.0}  # kN/m


def limit_equilibrium(friction):
    """Goodman and Bray (1976): ({n: force of block n + 1 on n, n = 0 the toe}, {n: "topples", "slides", "stands"}).

    From the top down, each block hands on what it needs to be held against toppling about its lower corner or sliding,
    with joints at their limit of friction. The forces act at the upper end of the contact of two blocks.
    """
    handed, forces, modes = 0.0, {}, {}
    for n in range(16, 0, -1):
        height, weight = HEIGHTS[n - 1], WEIGHTS[n - 1]
        above = min(height, HEIGHTS[n] + STEP) if n < 16 else height  # the arm of the force from above
        below = min(height, HEIGHTS[n - 2] - STEP) if n > 1 else height  # that of the force on the block below
        topples = handed * (above - WIDTH * friction) + 0.5 * weight * (height * math.sin(ALPHA) - WIDTH * math.cos(ALPHA))
        topples = topples / below
        slides = handed - weight * (friction * math.cos(ALPHA) - math.sin(ALPHA)) / (1 - friction**2)
        handed = max(topples, slides, 0.0)
        modes[n] = "stands" if handed == 0.0 else "topples" if handed == topples else "slides"
        forces[n - 1] = handed
    return forces, modes


def root(function, low, high):
    """Zero of a function that falls, by secants between the two."""
    left, right = function(low), function(high)
    for _ in range(4):
        middle = low - left * (high - low) / (right - left)
        value = function(middle)
        if value > 0:
            low, left = middle, value
        else:
            high, right = middle, value
    return low - left * (high - low) / (right - left)


def toe_force(friction):
    """Of the toe, without regard to sign, where blocks 1 to 3 slide."""
    return limit_equilibrium(friction)[0][3] - sliding_resistance(friction)


def sliding_resistance(friction):
    """What blocks 1 to 3 bear from above, with joints at their limit of friction."""
    return sum(WEIGHTS[:3]) * (friction * math.cos(ALPHA) - math.sin(ALPHA)) / (1 - friction**2)


def bisected_limit():
    low, high = 0.7, 0.9
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if toe_force(middle) > 0 else (low, middle)
    return low


def moving(case, friction, stiffness, defaults=False):
    """Forces P_n of blocks 4 to 13 (N/m) while they topple, and the run."""
    run = case.run(f"moving-{friction:.6f}-{stiffness:g}", {
        "interfaces.joint.friction_angle": math.degrees(math.atan(friction)),
        "interfaces.joint.normal_stiffness": stiffness, "interfaces.joint.shear_stiffness": stiffness,
        "stages.1.displacement.value": -3e-4 * 1e11 / stiffness, "output.fields": False}, "moving.yaml", defaults=defaults)
    return {n: run.histories[f"p{n}.normal_force"][-1] for n in range(3, 13)}, run


def check(case):
    limit = bisected_limit()
    case.expect("own limit equilibrium: tan phi against the published one", 0.7855, limit, 1e-3)
    expected, modes = limit_equilibrium(limit)
    case.expect_same("own limit equilibrium: 14-16 stand, 4-13 topple, 1-3 slide", "3, 10, 3",
                     ", ".join(str(list(modes.values()).count(mode)) for mode in ("stands", "topples", "slides")))
    stiffnesses = np.array([1e10, 3e10, 1e11])
    runs = [moving(case, limit, stiffness) for stiffness in stiffnesses]
    numbers = range(12, 2, -1)
    target = np.array([expected[n] for n in numbers])
    found = [np.array([forces[n] for n in numbers]) for forces, _ in runs]
    case.expect_worst("P12 to P3 of toppling blocks, k_n 1e+11 Pa/m", target / 1e3, found[-1] / 1e3, 5e-3, "kN/m", digits=6)
    case.expect_worst("the same against published forces, P12 to P4", list(PUBLISHED.values()), found[-1][:9] / 1e3, 5e-3, "kN/m", digits=6)
    joints = runs[-1][1].histories
    ratio = [abs(joints[f"p{n}.shear_force"][-1]) / joints[f"p{n}.normal_force"][-1] for n in range(4, 13)]
    case.expect_worst("their friction is mobilised: Q/P over tan phi", 1.0, np.array(ratio) / limit, 5e-3, digits=5)
    forces = moving(case, limit, stiffnesses[-1], True)[0]
    case.expect_default("P12 to P3 of toppling blocks", target / 1e3, [forces[n] / 1e3 for n in numbers], "kN/m")
    bearing = root(lambda friction: moving(case, friction, 1e11)[0][3] - sliding_resistance(friction), 0.76, 0.81)
    case.expect("tan phi at which three sliding blocks bear them", limit, bearing, 5e-3, digits=5)
    whole = case.run("whole", {"output.fields": False}).summary["factor_of_safety"]
    case.expect("all 16 blocks, reduction from rest: tan phi", limit, 0.7855 / whole, 5e-3, digits=5)
    errors = np.array([np.max(np.abs(values / target - 1)) for values in found])
    draw(case, numbers, target, found[-1], stiffnesses, errors)


def base_steps():
    """Corners of the base from the right to the left, in widths and steps."""
    return [corner for n in range(16, 0, -1) for corner in ((n, n - 1), (n - 1, n - 1))]


def draw(case, numbers, target, found, stiffnesses, errors):
    figure, (sketch, plot, order) = case.figure(10.5, 3.4, plots=2, ratios=[0.9, 0.8, 0.7])
    turn = np.array([[math.cos(ALPHA), -math.sin(ALPHA)], [math.sin(ALPHA), math.cos(ALPHA)]])
    colours = {"stands": figures.ROCK, "topples": "#d9b8a8", "slides": "#b8cbd9"}
    modes = limit_equilibrium(bisected_limit())[1]
    for n, height in enumerate(HEIGHTS, start=1):
        x, y = WIDTH * (n - 1), STEP * (n - 1)
        corners = [(x, y), (x + WIDTH, y), (x + WIDTH, y + height), (x, y + height)]
        figures.block(sketch, [turn @ corner for corner in corners], facecolor=colours[modes[n]])
        if n in (1, 4, 10, 13, 16):
            figures.label(sketch, turn @ [x + 5, y + height + 3], str(n))
    base = [(0, -14), (160, 1)] + [(WIDTH * n, STEP * level) for n, level in base_steps()]
    figures.block(sketch, [turn @ corner for corner in base], zorder=0)
    figures.label(sketch, (20, 90), "red: topple\nblue: slide\ngrey: stand")
    plot.plot(list(numbers), target / 1e3, color=figures.INK, linewidth=1.0, label="limit equilibrium")
    plot.plot(list(PUBLISHED), list(PUBLISHED.values()), "s", markersize=8, markerfacecolor="none", color=figures.SECOND, label="published")
    plot.plot(list(numbers), found / 1e3, "o", color=figures.FOUND, label="run")
    plot.set(xlabel="n", ylabel="$P_n$ (kN/m)", ylim=(0, None))
    plot.legend()
    order.loglog(stiffnesses, errors, "o-", color=figures.FOUND, label=f"order {-order_of_convergence(stiffnesses, errors):.2f}")
    order.axhline(5e-3, color=figures.PALE, linestyle="--", linewidth=0.9)
    figures.label(order, (3e10, 5.5e-3), "tolerance", color=figures.PALE)
    order.set(xlabel="$k_n$ (Pa/m)", ylabel="largest error of $P_{12}$ to $P_3$")
    order.legend()
    case.save_figure(figure)
