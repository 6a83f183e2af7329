"""Modulus of a jointed column."""

import numpy as np

from suite import figures

E, NU, SPACING = 10e9, 0.25, 1.0


def rock_modulus(plane):
    return E if plane == "stress" else E / (1 - NU**2)


def column_modulus(plane, stiffness):
    return 1 / (1 / rock_modulus(plane) + 1 / (stiffness * SPACING))


def check(case):
    found = {}
    for plane in ("stress", "strain"):
        for stiffness in (1e9, 3e9, 10e9, 30e9, 100e9):
            run = case.run(f"{plane}-{stiffness:g}", {"analysis.plane": plane, "interfaces.joint.normal_stiffness": stiffness})
            found[plane, stiffness] = run.history["axial_stress"][-1] / run.history["axial_strain"][-1]
        case.expect(f"modulus of the column, plane {plane}, k_n s = E", column_modulus(plane, 10e9) / 1e9, found[plane, 10e9] / 1e9, 1e-6,
                    "GPa")
    case.expect_worst("modulus, all", [column_modulus(*key) / 1e9 for key in found], [value / 1e9 for value in found.values()], 1e-6,
                      "GPa")
    figure, (sketch, plot) = case.figure(7.2, 3.2)
    for low, high in ((0, 0.5), (0.5, 1.5), (1.5, 2.5), (2.5, 3.5), (3.5, 4)):
        figures.block(sketch, [(0, low), (1, low), (1, high), (0, high)])
    figures.smooth_support(sketch, (0, 0), (1, 0), 0.15)
    for x in (0.2, 0.5, 0.8):
        figures.arrow(sketch, (x, 4.7), (x, 4.05))
    figures.arrow(sketch, (1.25, 1.5), (1.25, 2.5), "s", (0.2, 0), figures.INK, "<|-|>")
    figures.label(sketch, (1.45, 0.5), "$k_n$")
    figures.label(sketch, (0.5, 3.0), "$E_r$")
    ratio = np.logspace(-1.2, 1.2, 200)
    for colour, plane in ((figures.FOUND, "stress"), (figures.SECOND, "strain")):
        plot.semilogx(ratio, [column_modulus(plane, k * E) / 1e9 for k in ratio], color=colour, linewidth=1.0)
        plot.plot([k / E for p, k in found if p == plane], [value / 1e9 for (p, _), value in found.items() if p == plane], "o",
                  color=colour, label=f"plane {plane}")
    plot.set(xlabel="$k_n s/E$", ylabel="modulus of the column (GPa)")
    plot.legend(title="lines: theory, points: runs")
    case.save_figure(figure)
