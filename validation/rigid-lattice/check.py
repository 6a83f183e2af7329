"""Effective moduli of a net of rigid hexagons: those that the scene asks for."""

import math

import numpy as np

from suite import figures

D = 0.03


def lattice(plane, modulus, ratio):
    """(E', nu', k_n d, k_s d), two-dimensional: 2K and 2G of the rock, all of which the bonds have to carry."""
    twice_bulk = modulus / ((1 + ratio) * (1 - 2 * ratio)) if plane == "strain" else modulus / (1 - ratio)
    twice_shear = modulus / (1 + ratio)
    young = 2 * twice_bulk * twice_shear / (twice_bulk + twice_shear)
    return young, (twice_bulk - twice_shear) / (twice_bulk + twice_shear), twice_bulk, 2 * twice_shear - twice_bulk


def measured(run):
    """(E', nu') from blocks in the middle: strain of the net from displacements of centres, stress of a block."""
    blocks = run.blocks()
    motion = blocks.mean_displacements()
    row = D * math.sqrt(3) / 2
    middle = blocks.nearest((0.9, 2 * row))
    x, y = blocks.middles()[middle]
    right, left, upper = (blocks.nearest(place) for place in ((x + D, y), (x - D, y), (x, y + 2 * row)))
    strain_x = (motion[right, 0] - motion[left, 0]) / (2 * D)
    strain_y = (motion[upper, 1] - motion[middle, 1]) / (2 * row)
    return blocks["stress_yy"][middle] / strain_y, -strain_x / strain_y


def check(case):
    points = {}
    for plane, ratios in (("stress", (0.0, 0.1, 0.2, 0.3)), ("strain", (0.0, 0.05, 0.1, 0.15, 0.2, 0.24))):
        points[plane] = []
        for ratio in ratios:
            run = case.run(f"{plane}-{ratio:g}", {"analysis.plane": plane, "materials.block.poissons_ratio": ratio})
            points[plane].append((ratio, *measured(run), lattice(plane, 10e9, ratio)))
        case.expect_worst(f"modulus E', plane {plane}", [p[3][0] / 1e9 for p in points[plane]], [p[1] / 1e9 for p in points[plane]], 1e-6, "GPa")
        case.expect_worst(f"Poisson's ratio nu', plane {plane}", [p[3][1] for p in points[plane]], [p[2] for p in points[plane]], 1e-6, absolute=True)
    check_given_stiffnesses(case)
    draw(case, points)


def check_given_stiffnesses(case):
    """Blocks with E = 10 GPa and nu = 0.2 on given springs: the moduli of the same net of affine blocks (eq. 20)."""
    for plane in ("stress", "strain"):
        expected, found = [], []
        for normal, ratio in ((1e11, 0.4), (1e12, 0.5), (1e13, 1.0)):
            overrides = {"analysis.plane": plane, "materials.block.poissons_ratio": 0.2}
            for kind in ("bond", "joint"):
                overrides[f"interfaces.{kind}.normal_stiffness"] = normal
                overrides[f"interfaces.{kind}.shear_stiffness"] = ratio * normal
            twice_bulk = 10e9 / (1.2 * 0.6) if plane == "strain" else 10e9 / 0.8
            twice_bulk = 1 / (1 / twice_bulk + 1 / (D * normal))
            twice_shear = 1 / (1.2 / 10e9 + 2 / (D * normal * (1 + ratio)))
            expected.append((2 * twice_bulk * twice_shear / (twice_bulk + twice_shear), (twice_bulk - twice_shear) / (twice_bulk + twice_shear)))
            found.append(measured(case.run(f"given-{plane}-{normal:g}", overrides)))
        case.expect_worst(f"modulus E', given springs, plane {plane}", [e[0] / 1e9 for e in expected], [f[0] / 1e9 for f in found], 1e-6, "GPa")
        case.expect_worst(f"Poisson's ratio nu', given springs, plane {plane}", [e[1] for e in expected], [f[1] for f in found], 1e-6, absolute=True)


def draw(case, points):
    figure, (sketch, left, right) = case.figure(9.2, 3.2, plots=2, ratios=[0.75, 1, 1])
    for row in range(4):
        for column in range(5):
            x, y = column + 0.5 * (row % 2), row * math.sqrt(3) / 2
            angles = np.radians(30 + 60 * np.arange(6))
            figures.block(sketch, np.transpose([x + 0.93 * np.cos(angles) / math.sqrt(3), y + 0.93 * np.sin(angles) / math.sqrt(3)]))
    for x in (0.5, 2.0, 3.5):
        figures.arrow(sketch, (x, 3.95), (x, 3.25))
        figures.arrow(sketch, (x, -1.4), (x, -0.65))
    figures.label(sketch, (2.0, 4.3), "rigid hexagons, $k_n, k_s$ on all edges")
    for plane, colour in (("stress", figures.FOUND), ("strain", figures.SECOND)):
        limit = 1 / 3 if plane == "stress" else 1 / 4
        ratio = np.linspace(0, limit, 100)
        expected = np.array([lattice(plane, 10e9, value)[:2] for value in ratio])
        left.plot(ratio, expected[:, 0] / 1e9, color=colour, linewidth=1.0)
        right.plot(ratio, expected[:, 1], color=colour, linewidth=1.0)
        left.plot([p[0] for p in points[plane]], [p[1] / 1e9 for p in points[plane]], "o", color=colour, label=f"plane {plane}")
        right.plot([p[0] for p in points[plane]], [p[2] for p in points[plane]], "o", color=colour)
    left.set(xlabel=r"$\nu$ of the rock", ylabel="$E'$ of the net (GPa)")
    right.set(xlabel=r"$\nu$ of the rock", ylabel=r"$\nu'$ of the net")
    left.legend(title="lines: theory")
    case.save_figure(figure)
