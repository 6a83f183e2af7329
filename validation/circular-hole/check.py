"""Stress around a circular hole, in a strip and in a ring, at three sizes of hexagons each."""

import math

import numpy as np

from suite import figures
from suite.case import order_of_convergence

RADIUS, HALF_WIDTH, HEIGHT, OUTER, PRESSURE = 1.0, 5.0, 12.0, 4.0, 1e3
N_SIDES = 90  # of the half circle


def kirsch(r):
    """Compression along the load on the axis across it, over the pressure, in an infinite plate."""
    s = (RADIUS / np.asarray(r)) ** 2
    return 1 + 0.5 * s + 1.5 * s**2


def heywood():
    """Largest stress over the gross stress in a strip (Howland 1930, in the form of Heywood 1952)."""
    share = RADIUS / HALF_WIDTH
    return (2 + (1 - share) ** 3) / (1 - share)


def lame(r):
    """Hoop compression in a ring under outer pressure, over the pressure."""
    return OUTER**2 / (OUTER**2 - RADIUS**2) * (1 + (RADIUS / np.asarray(r)) ** 2)


def half_circle(radius, n):
    """From (radius, 0) counter-clockwise to (-radius, 0)."""
    angles = math.pi * np.arange(n + 1) / n
    points = [[radius * math.cos(a), radius * math.sin(a)] for a in angles]
    points[0], points[-1] = [radius, 0.0], [-radius, 0.0]
    return points


def strip_of(spacing):
    w = HALF_WIDTH
    inner = half_circle(RADIUS, N_SIDES)[::-1]
    return {"geometry.domain.polygon": [[RADIUS, 0.0], [w, 0.0], [w, HEIGHT], [-w, HEIGHT], [-w, 0.0], *inner[:-1]],
            "geometry.tessellation.hexagons.spacing": spacing}


def ring_of(spacing):
    n = 2 * N_SIDES
    outer, inner = half_circle(OUTER, n), half_circle(RADIUS, N_SIDES)[::-1]
    return {"geometry.domain.polygon": [[RADIUS, 0.0], *outer, *inner[:-1]], "geometry.tessellation.hexagons.spacing": spacing,
            "boundaries.middle.sides": [0, n + 1], "boundaries.outside.sides": list(range(1, n + 1))}


def along_axis(run):
    """(x, compression across the axis) of the blocks on it, outwards from the wall, both sides."""
    blocks = run.blocks()
    lowest = np.array([blocks.points[cell, 1].min() for cell in blocks.cells])
    on_axis = lowest < 1e-9
    x = np.abs(blocks.middles()[on_axis, 0])
    order = np.argsort(x)
    return x[order], -blocks["stress_yy"][on_axis][order] / PRESSURE


def at_wall(x, stress, powers):
    """By least squares of a sum of these powers of 1/x^2 over the blocks within three radii."""
    near = x < 3 * RADIUS
    s = (RADIUS / x[near]) ** 2
    return float(np.linalg.lstsq(np.transpose([s**power for power in powers]), stress[near], rcond=None)[0].sum())


def check(case):
    strip_sizes = [RADIUS / n for n in (1.75, 3.5, 7)]
    strips = [along_axis(case.run(f"strip-{i}", strip_of(size))) for i, size in enumerate(strip_sizes)]
    strip_walls = [at_wall(*profile, (0, 1, 2)) for profile in strips]
    case.expect("strip: stress at the wall over the pressure, d = a/7", heywood(), strip_walls[-1], 2e-2, digits=5)
    ring_sizes = [RADIUS / n for n in (2.5, 5, 10)]
    rings = [along_axis(case.run(f"ring-{i}", ring_of(size), scene="ring.yaml")) for i, size in enumerate(ring_sizes)]
    ring_walls = [at_wall(*profile, (0, 1)) for profile in rings]
    case.expect("ring: hoop stress at the wall over the pressure, d = a/10", float(lame(RADIUS)), ring_walls[-1], 2e-2, digits=5)
    x, stress = rings[-1]
    inside = (x > 1.2) & (x < 0.95 * OUTER)
    case.expect_worst("ring: hoop stress of the blocks on the axis, d = a/10", lame(x[inside]), stress[inside], 2e-2, digits=5)
    draw(case, strip_sizes, strips, strip_walls, ring_sizes, rings, ring_walls)


def draw(case, strip_sizes, strips, strip_walls, ring_sizes, rings, ring_walls):
    figure, (sketch, left, right) = case.figure(9.4, 3.3, plots=2, ratios=[0.7, 1, 1])
    angle = np.linspace(math.pi, 0, 60)
    figures.block(sketch, [(1, 0), (3, 0), (3, 4), (-3, 4), (-3, 0), *np.transpose([np.cos(angle), np.sin(angle)])])
    figures.smooth_support(sketch, (1, 0), (3, 0), 0.3)
    figures.smooth_support(sketch, (-3, 0), (-1, 0), 0.3)
    for place in (-2, 0, 2):
        figures.arrow(sketch, (place, 5.0), (place, 4.1))
    figures.arrow(sketch, (0, 0), (0.7, 0.7), "a", (-0.2, 0.2), figures.INK)
    r = np.linspace(1, 4, 200)
    left.plot(r, kirsch(r), color=figures.INK, linewidth=1.0, label="Kirsch, infinite plate")
    left.plot([1], [heywood()], "D", color=figures.INK, markersize=5, markerfacecolor="none", label="Howland, this strip, wall")
    left.plot(r, lame(r), "--", color=figures.INK, linewidth=1.0, label="Lamé, this ring")
    for (x, stress), colour, name in ((strips[-1], figures.FOUND, "strip, d = a/7"), (rings[-1], figures.SECOND, "ring, d = a/10")):
        near = x < 4
        left.plot(x[near], stress[near], "o", color=colour, markersize=3.0, label=name)
    left.set(xlabel="distance / a", ylabel="stress across the axis / p", ylim=(0.9, 3.4))
    left.legend(fontsize=7.5)
    for sizes, walls, exact, colour, name in ((strip_sizes, strip_walls, heywood(), figures.FOUND, "strip"),
                                              (ring_sizes, ring_walls, float(lame(RADIUS)), figures.SECOND, "ring")):
        errors = [abs(wall / exact - 1) for wall in walls]
        right.loglog(sizes, errors, "o-", color=colour, label=f"{name}, order {order_of_convergence(sizes, errors):.2f}")
    right.axhline(2e-2, color=figures.PALE, linestyle=":", linewidth=0.9)
    right.set(xlabel="d / a", ylabel="error at the wall")
    right.legend()
    case.save_figure(figure)
