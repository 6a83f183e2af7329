"""Effective moduli of the net against those of a periodic cell (docs/theory.md, eq. 19 and 20)."""

import math

import numpy as np

from suite import figures

E, NU, D = 10e9, 0.25, 0.03


def moduli_of(plane):
    """2K and 2G of the blocks, two-dimensional."""
    twice_bulk = E / ((1 + NU) * (1 - 2 * NU)) if plane == "strain" else E / (1 - NU)
    return twice_bulk, E / (1 + NU)


def lattice(plane, normal_stiffness, ratio):
    """(E', nu', G) of the net: 2K and 2G by eq. 20, then E' = 4KG/(K + G), nu' = (K - G)/(K + G)."""
    twice_bulk, twice_shear = moduli_of(plane)
    bulk = 0.5 / (1 / twice_bulk + 1 / (D * normal_stiffness))
    shear = 0.5 / (1 / twice_shear + 2 / (D * normal_stiffness * (1 + ratio)))
    return 4 * bulk * shear / (bulk + shear), (bulk - shear) / (bulk + shear), shear


def measured(run):
    """(E', nu') from blocks in the middle: strain of the net from displacements of centres, stress of the blocks."""
    blocks = run.blocks()
    centres, motion = blocks.middles(), blocks.mean_displacements()
    row = D * math.sqrt(3) / 2
    middle = blocks.nearest((0.9, 2 * row))
    x, y = centres[middle]
    right, left = (blocks.nearest((x + k * D, y)) for k in (1, -1))
    upper = blocks.nearest((x, y + 2 * row))
    for block, place in ((right, (x + D, y)), (left, (x - D, y)), (upper, (x, y + 2 * row))):
        assert np.linalg.norm(centres[block] - place) < 1e-9
    strain_x = (motion[right, 0] - motion[left, 0]) / (2 * D)
    strain_y = (motion[upper, 1] - motion[middle, 1]) / (2 * row)
    return blocks["stress_yy"][middle] / strain_y, -strain_x / strain_y


def check(case):
    curves = {}
    for plane, ratio in (("stress", 0.4), ("strain", 0.4), ("stress", 1.0), ("strain", 0.1)):
        points = []
        for normal in (1e11, 1e12, 1e13):
            overrides = {"analysis.plane": plane}
            for kind in ("bond", "joint"):
                overrides[f"interfaces.{kind}.normal_stiffness"] = normal
                overrides[f"interfaces.{kind}.shear_stiffness"] = ratio * normal
            modulus, poisson = measured(case.run(f"{plane}-{ratio:g}-{normal:g}", overrides))
            expected = lattice(plane, normal, ratio)
            points.append((normal, modulus, poisson, expected))
            if (plane, ratio, normal) in (("stress", 0.4, 1e11), ("strain", 0.4, 1e12)):
                where = f"plane {plane}, k_n {normal:g} Pa/m"
                case.expect(f"modulus E', {where}", expected[0] / 1e9, modulus / 1e9, 1e-6, "GPa")
                case.expect(f"Poisson's ratio nu', {where}", expected[1], poisson, 1e-6)
                case.expect(f"shear modulus G, {where}", expected[2] / 1e9, modulus / (2 * (1 + poisson)) / 1e9, 1e-6, "GPa")
        curves[(plane, ratio)] = points
    every = [point for points in curves.values() for point in points]
    case.expect_worst("E', all", [e[0] / 1e9 for *_, e in every], [m / 1e9 for _, m, _, _ in every], 1e-6, "GPa")
    case.expect_worst("nu', all", [e[1] for *_, e in every], [p for _, _, p, _ in every], 1e-6)
    draw(case, curves)


def draw(case, curves):
    figure, (sketch, left, right) = case.figure(9.2, 3.2, plots=2, ratios=[0.75, 1, 1])
    for row in range(4):
        for column in range(5):
            x, y = column + 0.5 * (row % 2), row * math.sqrt(3) / 2
            angles = np.radians(30 + 60 * np.arange(6))
            figures.block(sketch, np.transpose([x + np.cos(angles) / math.sqrt(3), y + np.sin(angles) / math.sqrt(3)]))
    for x in (0.5, 2.0, 3.5):
        figures.arrow(sketch, (x, 3.95), (x, 3.25))
        figures.arrow(sketch, (x, -1.4), (x, -0.65))
    figures.arrow(sketch, (1.0, 0.0), (2.0, 0.0), "d", (0, 0.3), figures.INK, "<|-|>")
    figures.label(sketch, (2.0, 4.3), "$k_n, k_s$ on all edges")
    normal = np.logspace(10.7, 13.3, 200)
    colours = (figures.FOUND, figures.SECOND, figures.THIRD, figures.INK)
    for colour, ((plane, ratio), points) in zip(colours, curves.items()):
        expected = np.array([lattice(plane, k, ratio) for k in normal])
        name = f"plane {plane}, $k_s/k_n$ {ratio:g}"
        for axes, column in ((left, 0), (right, 1)):
            scale = 1e9 if column == 0 else 1.0
            axes.semilogx(normal * D / E, expected[:, column] / scale, color=colour, linewidth=1.0)
            axes.plot([p[0] * D / E for p in points], [p[1 + column] / scale for p in points], "o", color=colour, label=name)
    left.set(xlabel="$k_n d/E$", ylabel="$E'$ of the net (GPa)")
    right.set(xlabel="$k_n d/E$", ylabel="$\\nu'$ of the net")
    right.legend(title="lines: theory, points: runs")
    case.save_figure(figure)
