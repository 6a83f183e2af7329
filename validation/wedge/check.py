"""Normal forces on the faces of a wedge."""

import math

import numpy as np

from suite import figures


def check(case):
    angles = [15, 30, 45, 60, 75]
    found, along, by_default = [], [], []
    for angle in angles:
        slope = math.tan(math.radians(angle))
        half = 1.1 / slope
        scene = {"geometry.domain.rectangle": {"width": 2 * half + 2, "height": 2, "origin": [-half - 1, -1]},
                 "geometry.fractures.0.trace": [[-half, 1.1], [0, 0], [half, 1.1]]}
        run = case.run(f"alpha-{angle}", scene)
        weight = 2500 * 10 / slope  # of the triangle of height 1
        faces = run.interfaces()
        force = -faces["normal_traction"] * faces.lengths() / weight
        case.expect_worst(f"N/W on both faces, alpha {angle} deg", 1 / (2 * math.cos(math.radians(angle))), force, 1e-6)
        found.append(force)
        along.append(np.abs(faces["shear_traction"] * faces.lengths() / weight).max())
        faces = case.run(f"alpha-{angle}", scene, defaults=True).interfaces()
        by_default.append(-faces["normal_traction"] * faces.lengths() / weight * 2 * math.cos(math.radians(angle)))
    case.expect_default("N over W / (2 cos alpha), all", 1.0, by_default)
    case.expect_worst("T/W on the faces", np.zeros(len(along)), along, 1e-6, absolute=True)
    figure, (sketch, plot) = case.figure()
    figures.block(sketch, [(-1.6, -0.5), (1.6, -0.5), (1.6, 1), (1, 1), (0, 0), (-1, 1), (-1.6, 1)])
    figures.block(sketch, [(-1, 1), (0, 0), (1, 1)], facecolor="#efe9df")
    figures.ground(sketch, (-1.6, -0.5), (1.6, -0.5), 0.12)
    figures.arrow(sketch, (0, 0.7), (0, 0.2), "W", (0.15, 0.1))
    for side in (-1, 1):
        figures.arrow(sketch, (side * 0.85, 0.15), (side * 0.5, 0.5), "N", (side * 0.1, -0.1), figures.SECOND)
    figures.line(sketch, [(0, 0), (0.7, 0)], linestyle=":")
    figures.label(sketch, (0.42, 0.15), r"$\alpha$")
    alpha = np.linspace(0, 80, 200)
    plot.plot(alpha, 0.5 / np.cos(np.radians(alpha)), color=figures.INK, linewidth=1.0, label=r"1 / (2 cos $\alpha$)")
    plot.plot(angles, [force[0] for force in found], "o", color=figures.FOUND, label="left face")
    plot.plot(angles, [force[1] for force in found], "s", markersize=8, markerfacecolor="none", color=figures.SECOND, label="right face")
    plot.set(xlabel=r"$\alpha$ (deg)", ylabel="N / W", ylim=(0, None))
    plot.legend()
    case.save_figure(figure)
