"""Deflection of a cantilever of hexagons under its weight, at three sizes."""

import math

import numpy as np

from suite import figures
from suite.case import order_of_convergence

LENGTH, DEPTH, E, SHEAR = 1.0, 0.2, 10e9, 5e9
LOAD = 2500 * 0.01 * DEPTH  # N/m per length
INERTIA = DEPTH**3 / 12
BENDING = LOAD * LENGTH**4 / (8 * E * INERTIA)
SHEARING = LOAD * LENGTH**2 / (2 * (5 / 6) * SHEAR * DEPTH)
DEFLECTION = BENDING + SHEARING


def hexagons(rows):
    """The spacing with `rows` rows of hexagons over the depth: both faces then run through centres."""
    return 2 * DEPTH / (math.sqrt(3) * rows)


def deflection(run):
    blocks = run.blocks()
    end = np.abs(blocks.points[:, 0] - LENGTH) < 1e-9
    height = blocks.points[end, 1]
    return -np.interp(DEPTH / 2, *zip(*sorted(zip(height, blocks.displacement[end, 1]))))


def known(rows, ratio):
    """With the known excess of bending stiffness 0.31 (k_n d/E)(d/W)^2."""
    return BENDING / (1 + 0.31 * ratio * (hexagons(rows) / DEPTH) ** 2) + SHEARING


def check(case):
    found = {}
    for ratio in (10, 5):
        for rows in (4, 8, 16):
            run = case.run(f"ratio-{ratio}-rows-{rows}", {
                "geometry.tessellation.hexagons": {"spacing": hexagons(rows), "offset": [0.3 * hexagons(rows), 0]},
                "interfaces.bond.stiffness_ratio": ratio, "interfaces.joint.stiffness_ratio": ratio})
            found[ratio, rows] = deflection(run)
        case.expect(f"deflection, 16 rows, k_n d/E {ratio}", DEFLECTION * 1e9, found[ratio, 16] * 1e9, 2e-2, "nm", digits=5)
        case.expect(f"with the known excess, 16 rows, k_n d/E {ratio}", known(16, ratio) * 1e9, found[ratio, 16] * 1e9, 2e-2, "nm", digits=5)
    draw(case, found)


def draw(case, found):
    figure, (sketch, plot) = case.figure(ratios=[0.9, 1])
    size = hexagons(4)
    for row in range(5):
        for column in range(-1, 24):
            x, y = (column + 0.5 * (row % 2)) * size, row * size * math.sqrt(3) / 2
            if x < 0 or x > 1:
                continue
            corners = np.radians(30 + 60 * np.arange(6))
            px = x + size / math.sqrt(3) * np.cos(corners)
            py = np.clip(y + size / math.sqrt(3) * np.sin(corners), 0, DEPTH)
            figures.block(sketch, np.transpose([px, py]), linewidth=0.6)
    figures.ground(sketch, (0, 0.25), (0, -0.05), -0.03)
    for x in (0.2, 0.5, 0.8):
        figures.arrow(sketch, (x, -0.03), (x, -0.15))
    figures.label(sketch, (0.62, -0.12), "weight", color=figures.FOUND)
    for colour, ratio in ((figures.FOUND, 10), (figures.SECOND, 5)):
        rows = np.array([4, 8, 16])
        size = np.array([hexagons(n) for n in rows]) / DEPTH
        error = np.array([1 - found[ratio, n] / DEFLECTION for n in rows])
        plot.loglog(size, np.abs(error), "o-", color=colour, label=f"runs, $k_n d/E$ = {ratio}, order {order_of_convergence(size, error):.2f}")
        fine = np.linspace(size.min(), size.max(), 50)
        plot.loglog(fine, 0.31 * ratio * fine**2 * BENDING / DEFLECTION, "--", color=colour, linewidth=0.9)
    plot.axhline(2e-2, color=figures.PALE, linestyle=":", linewidth=0.9)
    plot.set(xlabel="d / W", ylabel="1 - deflection / theory")
    plot.legend(title=r"dashed: 0.31 ($k_n d/E$) (d/W)$^2$ of the bending")
    case.save_figure(figure)
