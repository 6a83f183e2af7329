"""Stress in the middle of a disc pressed over two arcs, at three sizes of hexagons."""

import math

import numpy as np

from suite import figures
from suite.case import order_of_convergence

RADIUS, THICKNESS, FORCE = 0.027, 0.027, 10e3
HALF_ARC = math.radians(7.5)
N_SIDES = 144  # of the half circle
PRESSURE = FORCE / (THICKNESS * 2 * RADIUS * HALF_ARC)


def hondros(r):
    """(tension across the loaded diameter, compression along it) at the distance r from the middle, over the pressure."""
    s = (np.asarray(r) / RADIUS) ** 2
    first = (1 - s) * math.sin(2 * HALF_ARC) / (1 - 2 * s * math.cos(2 * HALF_ARC) + s**2)
    second = np.arctan((1 + s) / np.maximum(1 - s, 1e-12) * math.tan(HALF_ARC))
    return 2 / math.pi * (first - second), 2 / math.pi * (first + second)


def scene_of(spacing):
    angles = math.pi * np.arange(N_SIDES + 1) / N_SIDES
    corners = [[RADIUS * math.cos(a), RADIUS * math.sin(a)] for a in angles]
    corners[0][1] = corners[-1][1] = 0.0
    loaded = [i for i in range(N_SIDES) if abs(0.5 * (angles[i] + angles[i + 1]) - math.pi / 2) < HALF_ARC]
    return {"geometry.domain.polygon": corners, "boundaries.middle.sides": [N_SIDES], "boundaries.arc.sides": loaded,
            "stages.0.pressure.arc": PRESSURE, "geometry.tessellation.hexagons.spacing": spacing}


def check(case):
    sizes = [2 * RADIUS / n for n in (16, 32, 64)]
    runs = [case.run(f"d-{i}", scene_of(size)) for i, size in enumerate(sizes)]
    tension, compression = hondros(0.0)
    found = []
    for run in runs:
        blocks = run.blocks()
        middle = blocks.nearest((0.0, 0.0))
        found.append((blocks["stress_xx"][middle], -blocks["stress_yy"][middle]))
    found = np.array(found)
    case.expect("tension in the middle, d = D/64", tension * PRESSURE / 1e6, found[-1, 0] / 1e6, 2e-2, "MPa", digits=5)
    case.expect("compression in the middle, d = D/64", compression * PRESSURE / 1e6, found[-1, 1] / 1e6, 2e-2, "MPa", digits=5)
    draw(case, sizes, found, runs[-1])


def draw(case, sizes, found, run):
    figure, (sketch, left, right) = case.figure(9.4, 3.2, plots=2, ratios=[0.7, 1, 1])
    angle = np.linspace(0, 2 * math.pi, 100)
    figures.block(sketch, np.transpose([np.cos(angle), np.sin(angle)]))
    for shift in (-0.1, 0.0, 0.1):
        figures.arrow(sketch, (shift, 1.4), (shift, 1.02))
        figures.arrow(sketch, (shift, -1.4), (shift, -1.02))
    figures.label(sketch, (0.35, 1.25), "P/t", color=figures.FOUND)
    figures.line(sketch, [(-1, 0), (1, 0)], linestyle=":")
    figures.label(sketch, (0.6, 0.12), "half computed", fontsize=7)
    blocks = run.blocks()
    middles = blocks.middles()
    axis = (np.abs(middles[:, 0]) < 1e-6) & (middles[:, 1] < 0.98 * RADIUS)
    r = np.linspace(0, 0.99 * RADIUS, 200)
    theory = hondros(r)
    left.plot(r / RADIUS, theory[0] * PRESSURE / 1e6, color=figures.INK, linewidth=1.0, label="Hondros")
    left.plot(r / RADIUS, -theory[1] * PRESSURE / 1e6, color=figures.INK, linewidth=1.0)
    left.plot(middles[axis, 1] / RADIUS, blocks["stress_xx"][axis] / 1e6, "o", color=figures.FOUND, markersize=3, label="across, d = D/64")
    left.plot(middles[axis, 1] / RADIUS, blocks["stress_yy"][axis] / 1e6, "s", color=figures.SECOND, markersize=3, label="along")
    left.set(xlabel="distance from the middle / radius", ylabel="stress (MPa, tension positive)", ylim=(-60, 10))
    left.legend()
    exact = np.array(hondros(0.0)) * PRESSURE
    errors = np.abs(found / exact - 1)
    for column, name, colour in ((0, "tension", figures.FOUND), (1, "compression", figures.SECOND)):
        right.loglog(np.array(sizes) / (2 * RADIUS), errors[:, column], "o-", color=colour,
                     label=f"{name}, order {order_of_convergence(sizes, errors[:, column]):.2f}")
    right.axhline(2e-2, color=figures.PALE, linestyle=":", linewidth=0.9)
    right.set(xlabel="d / D", ylabel="error in the middle")
    right.legend()
    case.save_figure(figure)
