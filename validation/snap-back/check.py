"""Strength, and energy lost when a bar tears."""

import numpy as np

from suite import figures

E, STIFFNESS, STRENGTH = 1e13, 1e13, 0.1e6


def energy(length):
    """Per area (J/m2): elastic energy of bar and interface at the strength, all of it lost at fixed ends."""
    return STRENGTH**2 / 2 * (length / E + 1 / STIFFNESS)


def check(case):
    lengths, curves = [0.5, 2.0, 8.0], {}
    for length in lengths:
        limit = STRENGTH * (length / E + 1 / STIFFNESS) / length
        table = case.run(f"length-{length:g}", {
            "geometry.domain.rectangle.height": length, "geometry.fractures.0.trace": [[-0.1, length / 2], [1.1, length / 2]],
            "stages.0.strain.value": -1.3 * limit}).equilibria
        # The table begins with the first load step; the body as it was cut is at rest.
        curves[length] = (np.append(0.0, -table["axial_strain"] * length), np.append(0.0, -table["axial_stress"]))
        case.expect_same(f"cracks, L {length:g} m", 1, int(table["cracks_tension"][-1]))
    case.expect_worst("strength", [STRENGTH / 1e6] * 3, [stress.max() / 1e6 for _, stress in curves.values()], 1e-6, "MPa")
    for length, (travel, stress) in curves.items():
        lost = np.sum(0.5 * (stress[1:] + stress[:-1]) * np.diff(travel))
        case.expect(f"energy lost, L {length:g} m", energy(length), float(lost), 1e-6, "J/m2")
    case.expect_worst("stress after the tear over the strength", [0.0] * 3, [stress[-1] / STRENGTH for _, stress in curves.values()], 1e-6,
                      absolute=True)
    figure, (sketch, plot) = case.figure()
    figures.block(sketch, [(0, 0), (0.5, 0), (0.5, 1), (0, 1)])
    figures.block(sketch, [(0, 1), (0.5, 1), (0.5, 2), (0, 2)])
    figures.line(sketch, [(0, 1), (0.5, 1)], color=figures.SECOND, linewidth=2.2)
    figures.label(sketch, (0.85, 1.0), "$T, k_n$", color=figures.SECOND)
    figures.label(sketch, (0.7, 1.5), "E")
    figures.smooth_support(sketch, (0, 0), (0.5, 0), 0.08)
    figures.arrow(sketch, (0.25, 2.02), (0.25, 2.4), "u", (0.12, 0))
    figures.arrow(sketch, (-0.2, 0), (-0.2, 2), "L", (-0.12, 0), figures.INK, "<|-|>")
    for colour, (length, (travel, stress)) in zip((figures.THIRD, figures.FOUND, figures.SECOND), curves.items()):
        limit = STRENGTH * (length / E + 1 / STIFFNESS)
        plot.plot(np.array([0, limit, limit, 1.3 * limit]) * 1e9, np.array([0, STRENGTH, 0, 0]) / 1e6, color=colour, linewidth=1.0)
        plot.plot(1e9 * travel, stress / 1e6, "o", color=colour, label=f"run, L = {length:g} m")
    plot.set(xlabel="u (nm)", ylabel="stress (MPa)", xlim=(0, None), ylim=(0, None))
    plot.legend(title="lines: theory")
    case.save_figure(figure)
