"""Contact forces and closures in a stack under its weight."""

import numpy as np

from suite import figures

BLOCK = 1.0 * 2500 * 10  # weight of one, N/m
STIFFNESS, LENGTH = 1e12, 1.0


def check(case):
    faces = case.run("weight").interfaces()
    height = faces.middles()[:, 1]
    above = (5 - np.round(height)) * BLOCK
    force = -faces["normal_traction"] * faces.lengths()
    closure = -faces["gap"]
    case.expect_worst("contact force = weight above", above / 1e3, force / 1e3, 1e-6, "kN/m")
    case.expect_worst("closure = W/(k_n L)", 1e9 * above / (STIFFNESS * LENGTH), 1e9 * closure, 1e-6, "nm")
    case.expect_worst("shear over normal traction", 0.0 * above, faces["shear_traction"] * faces.lengths() / force, 1e-6, absolute=True)
    figure, (sketch, plot) = case.figure(7.2, 3.2)
    for level in range(5):
        figures.block(sketch, [(0, level), (1, level), (1, level + 1), (0, level + 1)])
    figures.smooth_support(sketch, (0, 0), (1, 0), 0.15)
    figures.arrow(sketch, (1.5, 3.6), (1.5, 2.4), "g", (0.25, 0))
    levels = np.linspace(0, 5, 50)
    plot.plot((5 - levels) * BLOCK / 1e3, levels, color=figures.INK, linewidth=1.0, label="weight above")
    plot.plot(force / 1e3, height, "o", color=figures.FOUND, label="contact force")
    plot.plot(closure * STIFFNESS * LENGTH / 1e3, height, "s", markersize=8, markerfacecolor="none", color=figures.SECOND, label="closure times $k_n L$")
    plot.set(xlabel="force (kN/m)", ylabel="height (m)", xlim=(0, None))
    plot.legend()
    case.save_figure(figure)
