"""Stress around a circular hole, at three sizes of hexagons."""

import math

import numpy as np

from suite import figures
from suite.case import order_of_convergence

RADIUS, HALF_WIDTH, PRESSURE = 1.0, 10.0, 1e3
N_SIDES = 90  # of the half circle


def kirsch(r):
    """Compression along the load on the axis across it, over the pressure, in an infinite plate."""
    s = (RADIUS / np.asarray(r)) ** 2
    return 1 + 0.5 * s + 1.5 * s**2


def heywood():
    """Largest stress over the gross stress in a plate of finite width (Howland 1930; fit of Heywood 1952)."""
    share = RADIUS / HALF_WIDTH
    return (2 + (1 - share) ** 3) / (1 - share)


def scene_of(spacing):
    angles = math.pi * np.arange(N_SIDES, -1, -1) / N_SIDES
    arc = [[RADIUS * math.cos(a), RADIUS * math.sin(a)] for a in angles]
    arc[0], arc[-1] = [-RADIUS, 0.0], [RADIUS, 0.0]
    w = HALF_WIDTH
    return {"geometry.domain.polygon": [[RADIUS, 0.0], [w, 0.0], [w, w], [-w, w], [-w, 0.0], *arc[:-1]],
            "geometry.tessellation.hexagons.spacing": spacing}


def along_axis(run):
    """(x, compression along the load) of the blocks on the axis across the load, outwards from the wall, both sides."""
    blocks = run.blocks()
    lowest = np.array([blocks.points[cell, 1].min() for cell in blocks.cells])
    on_axis = lowest < 1e-9
    x = np.abs(blocks.middles()[on_axis, 0])
    order = np.argsort(x)
    return x[order], -blocks["stress_yy"][on_axis][order] / PRESSURE


def at_wall(x, stress):
    """By least squares of a form like Kirsch's, A + B/x^2 + C/x^4, over the blocks within three radii."""
    near = x < 3 * RADIUS
    s = (RADIUS / x[near]) ** 2
    return float(np.linalg.lstsq(np.transpose([np.ones_like(s), s, s**2]), stress[near], rcond=None)[0].sum())


def check(case):
    sizes = [RADIUS / n for n in (2.5, 5, 10)]
    profiles = [along_axis(case.run(f"d-{i}", scene_of(size))) for i, size in enumerate(sizes)]
    walls = [at_wall(*profile) for profile in profiles]
    case.expect("stress at the wall over the pressure, d = a/10", heywood(), walls[-1], 2e-2, digits=5)
    x, stress = profiles[-1]
    for place in (1.5, 2.0, 3.0):
        i = int(np.argmin(np.abs(x - place)))
        case.expect(f"stress on the axis near {place:g} a (Kirsch)", float(kirsch(x[i])), stress[i], 2e-2, digits=5)
    draw(case, sizes, profiles, walls)


def draw(case, sizes, profiles, walls):
    figure, (sketch, left, right) = case.figure(9.4, 3.2, plots=2, ratios=[0.7, 1, 1])
    angle = np.linspace(math.pi, 0, 60)
    figures.block(sketch, [(1, 0), (4, 0), (4, 4), (-4, 4), (-4, 0), *np.transpose([np.cos(angle), np.sin(angle)])])
    figures.smooth_support(sketch, (1, 0), (4, 0), 0.3)
    figures.smooth_support(sketch, (-4, 0), (-1, 0), 0.3)
    for place in (-3, -1, 1, 3):
        figures.arrow(sketch, (place, 5.2), (place, 4.1))
    figures.arrow(sketch, (0, 0), (0.7, 0.7), "a", (-0.2, 0.2), figures.INK)
    r = np.linspace(1, 5, 200)
    left.plot(r, kirsch(r), color=figures.INK, linewidth=1.0, label="Kirsch")
    for colour, marker, (x, stress), name in zip((figures.THIRD, figures.SECOND, figures.FOUND), "^so", profiles, ("2.5", "5", "10")):
        near = x < 5
        left.plot(x[near], stress[near], marker, color=colour, markersize=3.5, label=f"d = a/{name}")
    left.set(xlabel="distance / a", ylabel="stress on the axis / p", ylim=(0.9, 3.2))
    left.legend()
    errors = [abs(wall / heywood() - 1) for wall in walls]
    right.loglog(sizes, errors, "o-", color=figures.FOUND, label=f"at the wall, order {order_of_convergence(sizes, errors):.2f}")
    right.axhline(2e-2, color=figures.PALE, linestyle=":", linewidth=0.9)
    right.set(xlabel="d / a", ylabel="error")
    right.legend()
    case.save_figure(figure)
