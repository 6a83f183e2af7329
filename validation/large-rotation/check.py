"""Area of a block that turns by 90 degrees."""

import math

import numpy as np

from suite import figures

LENGTH, WIDTH, MODULUS, RATIO, PULL = 2.0, 1.0, 1e9, 0.25, 1e4


def area_ratio(fields):
    """Area after over area before."""

    def area(points):
        x, y = points.T
        return 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))

    before = fields.points[fields.cells[0]]
    return area(before + fields.displacement[fields.cells[0]]) / area(before)


def check(case):
    counts = [1, 2, 3, 9, 30, 90]
    changes = {}
    for kinematics in ("affine", "rigid"):
        runs = [case.run(f"{kinematics}-{n}", {"stages.1.steps": n, "analysis.kinematics": kinematics}) for n in counts]
        ratios = np.array([area_ratio(run.blocks()) for run in runs])
        changes[kinematics] = np.abs(ratios - 1)
        case.expect_worst(f"{kinematics}: area after over before", 1.0, ratios, 1e-12)
        case.expect_worst(f"{kinematics}: rotation", math.pi / 2, [run.histories["bar.rotation"][-1] for run in runs], 1e-6, "rad", digits=9)
        angles = [run.histories["bar.rotation"][2:-1] for run in runs]
        shares = [np.arange(1, n + 1) / n for n in counts]
        case.expect_worst(f"{kinematics}: rotation on the way", np.concatenate([np.arctan2(share, 1 - share) for share in shares]),
                          np.concatenate(angles), 1e-6, "rad", digits=9)
        if kinematics == "affine":
            stress = np.array([[run.histories[f"bar.stress_{part}"][-2] for part in ("xx", "yy", "xy")] for run in runs])
            pulled = PULL / (WIDTH * (1 - RATIO * PULL / (WIDTH * MODULUS)))
            case.expect_worst("stress along the bar, turned and pulled", pulled / 1e3, -stress[:, 1] / 1e3, 1e-6, "kPa")
            case.expect_worst("stress across it and shear, over that", 0.0, stress[:, [0, 2]] / pulled, 1e-6, absolute=True)
    draw(case, counts, changes)


def draw(case, counts, changes):
    figure, (sketch, plot) = case.figure()
    corners = np.array([(-1, -0.5), (1, -0.5), (1, 0.5), (-1, 0.5)])
    for angle, shade in ((0, "#f1ece3"), (45, "#eae3d7"), (90, figures.ROCK)):
        turn = np.array([[math.cos(math.radians(angle)), -math.sin(math.radians(angle))],
                         [math.sin(math.radians(angle)), math.cos(math.radians(angle))]])
        figures.block(sketch, corners @ turn.T, facecolor=shade, alpha=0.75)
        for side in (-1, 1):
            figures.arrow(sketch, turn @ [side, 0], turn @ [1.6 * side, 0], colour=figures.FOUND)
    figures.label(sketch, (1.5, -0.25), "F")
    n = np.array(counts, float)
    plot.loglog(n, (1 + (math.pi / 2 / n) ** 2) ** n - 1, "--", color=figures.INK, linewidth=1.0, label=r"rotation linearised in each step, $(1+\omega^2)^n - 1$")
    floor = 1e-17  # no change at all is drawn here
    plot.loglog(n, np.maximum(changes["affine"], floor), "o", color=figures.FOUND, label="affine")
    plot.loglog(n, np.maximum(changes["rigid"], floor), "s", markersize=8, markerfacecolor="none", color=figures.SECOND, label="rigid")
    plot.axhline(1e-12, color=figures.PALE, linestyle="--", linewidth=0.9)
    figures.label(plot, (50, 3e-12), "tolerance", color=figures.PALE)
    plot.set(xlabel="load steps", ylabel="change of area, relative", ylim=(3e-18, 300))
    plot.legend(loc="center left", bbox_to_anchor=(0, 0.62))
    case.save_figure(figure)
