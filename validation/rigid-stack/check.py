"""Forces, closures and rotations in a stack of rigid blocks."""

import numpy as np

from suite import figures

BLOCK = 1.0 * 2500 * 10  # weight of one, N/m
STIFFNESS, LENGTH = 1e14, 1.0
LOAD, OFFSET = 1e5, 0.1  # N/m, m from the axis


def check(case):
    histories = case.run("stack", {"output.fields": False}).histories
    levels = np.arange(1, 6)
    weights = BLOCK * (6 - levels)  # on each joint
    turning = -LOAD * OFFSET / (STIFFNESS * LENGTH**3 / 12)  # of each joint, clockwise
    results = []
    for row, load, name in ((1, 0.0, "weight"), (2, LOAD, "with the load")):
        force = np.array([histories[f"joint{i}.normal_force"][row] for i in levels])
        closure = -np.array([histories[f"joint{i}.opening"][row] for i in levels])
        shear = np.array([histories[f"joint{i}.shear_force"][row] for i in levels])
        case.expect_worst(f"{name}: contact force", (weights + load) / 1e3, force / 1e3, 1e-6, "kN/m")
        case.expect_worst(f"{name}: closure W/(k_n L)", 1e9 * (weights + load) / (STIFFNESS * LENGTH), 1e9 * closure, 1e-6, "nm")
        case.expect_worst(f"{name}: shear over normal force", 0.0, shear / force, 1e-6, absolute=True)
        sinking = np.array([-histories[f"b{i}.displacement_y"][row] for i in levels])
        case.expect_worst(f"{name}: settlement of blocks", 1e9 * np.cumsum(weights + load) / (STIFFNESS * LENGTH), 1e9 * sinking, 1e-6, "nm")
        results.append((force, sinking))
    rotation = np.array([histories[f"b{i}.rotation"][2] for i in levels])
    case.expect_worst("with the load: rotation of blocks", 1e9 * turning * levels, 1e9 * rotation, 1e-6, "1e-9 rad")
    drift = np.array([histories[f"b{i}.displacement_x"][2] for i in levels])
    sway = -turning * np.array([sum(i - j + 0.5 for j in range(1, i + 1)) for i in levels])  # joint j lies at j - 1, block i at i - 1/2
    case.expect_worst("with the load: sway of blocks", 1e9 * sway, 1e9 * drift, 1e-6, "nm")
    draw(case, weights, results)


def draw(case, weights, results):
    figure, (sketch, left, right) = case.figure(8.4, 3.3, plots=2, ratios=[0.5, 1, 1])
    for level in range(5):
        figures.block(sketch, [(0, level), (1, level), (1, level + 1), (0, level + 1)])
    figures.ground(sketch, (-0.5, 0), (1.5, 0), 0.2)
    figures.arrow(sketch, (0.6, 6), (0.6, 5), "P", (0.25, 0.1))
    figures.line(sketch, [(0.5, 0), (0.5, 5.4)], linestyle=":", linewidth=0.8)
    levels = np.arange(5)
    for load, (force, sinking), marker, colour, name in ((0.0, results[0], "o", figures.FOUND, "weight"),
                                                         (LOAD, results[1], "s", figures.SECOND, "with the load")):
        left.plot((weights + load) / 1e3, levels, color=figures.INK, linewidth=1.0)
        left.plot(force / 1e3, levels, marker, color=colour, label=name)
        right.plot(1e9 * np.cumsum(weights + load) / (STIFFNESS * LENGTH), levels + 0.5, color=figures.INK, linewidth=1.0)
        right.plot(1e9 * sinking, levels + 0.5, marker, color=colour, label=name)
    left.set(xlabel="contact force (kN/m)", ylabel="height (m)", xlim=(0, None))
    right.set(xlabel="settlement (nm)", xlim=(0, None))
    left.legend(title="lines: theory")
    case.save_figure(figure)
