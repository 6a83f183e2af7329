"""Stress at the failure of a bond, along the whole envelope."""

import math

import numpy as np

from suite import figures

C, PHI, TENSION = 0.16e6, math.radians(36.2), 0.1e6
SLOPE = (1 + math.sin(PHI)) / (1 - math.sin(PHI))
UNIAXIAL = 2 * C * math.cos(PHI) / (1 - math.sin(PHI))


def strength(p3):
    """Largest p1 beside p3 (compression positive), p3 > -T."""
    return UNIAXIAL + SLOPE * p3


def at_failure(run):
    """(axial stress, lateral stress, mode) of the equilibrium just before the first crack."""
    table = run.equilibria
    before = np.flatnonzero(table["cracks_tension"] + table["cracks_shear"] == 0)[-1]
    return table["axial_stress"][before], table["lateral_stress"][before], run.cracks["mode"][0]


def pressed(case, lateral, inward, defaults=False):
    sides = {"stages.0.pressure.left": lateral, "stages.0.pressure.right": lateral, "stages.0.pressure.top": max(lateral, 0.0)}
    return at_failure(case.run(f"lateral-{lateral:g}-{'in' if inward else 'out'}",
                               {**sides, "stages.1.displacement.value": 1.5e-5 if inward else -1.5e-5,
                                "stages.1.displacement.glued": "false" if inward else "true"}, defaults=defaults))


def check(case):
    points = []
    named = {-0.09999e6: "p1 near the corner, p3 = -0.09999 MPa", 0.0: "p1, uniaxial compression", 0.2e6: "p1 at p3 = 0.2 MPa"}
    for lateral in (-0.09999e6, -0.08e6, -0.04e6, 0.0, 0.1e6, 0.2e6, 0.5e6, 1.0e6):
        axial, _, mode = pressed(case, lateral, True)
        points.append((lateral, axial))
        if lateral in named:
            case.expect(named[lateral], strength(lateral) / 1e6, axial / 1e6, 1e-6, "MPa")
        if mode != "shear":
            case.expect_same(f"mode at p3 = {lateral / 1e6:g} MPa", "shear", str(mode))
    case.expect_worst("p1 on the line, all", [strength(p3) / 1e6 for p3, _ in points], [p1 / 1e6 for _, p1 in points], 1e-6, "MPa")
    plain = [pressed(case, lateral, True, defaults=True)[0] for lateral, _ in points]
    case.expect_default("p1 on the line, all", [strength(p3) / 1e6 for p3, _ in points], np.array(plain) / 1e6, "MPa")
    torn = []
    for lateral in (0.0, 0.1e6, 0.2e6):
        axial, beside, mode = pressed(case, lateral, False)
        torn.append((axial, beside))
        case.expect_same(f"mode in tension, lateral pressure {lateral / 1e6:g} MPa", "tension", str(mode))
    case.expect_worst("tension at failure", [TENSION / 1e6] * 3, [-p3 / 1e6 for p3, _ in torn], 1e-6, "MPa")
    pressure = 100e6
    squeezed = case.run("hydrostatic", {f"stages.0.pressure.{side}": pressure for side in ("left", "right", "top")} |
                        {"stages.1.displacement.value": 1e-9, "stages.0.steps": 10})
    case.expect_same("cracks under 100 MPa of hydrostatic pressure", 0,
                     int(squeezed.summary["cracks_tension"] + squeezed.summary["cracks_shear"]))
    draw(case, points, torn)


def draw(case, points, torn):
    figure, (sketch, plot) = case.figure()
    figures.block(sketch, [(0, 0), (1, 0), (1, 1), (0, 1)])
    figures.block(sketch, [(0, 1), (1, 1), (1, 2), (0, 2)])
    figures.line(sketch, [(0, 1), (1, 1)], color=figures.SECOND, linewidth=2.2)
    figures.label(sketch, (0.5, 1.13), "bond", color=figures.SECOND)
    figures.smooth_support(sketch, (0, 0), (1, 0), 0.1)
    for x in (0.2, 0.5, 0.8):
        figures.arrow(sketch, (x, 2.5), (x, 2.05), style="<|-|>")
    for y in (0.5, 1.5):
        figures.arrow(sketch, (-0.5, y), (-0.05, y))
        figures.arrow(sketch, (1.5, y), (1.05, y))
    p3 = np.array([-TENSION, 1.05e6])
    plot.plot(p3 / 1e6, strength(p3) / 1e6, color=figures.INK, linewidth=1.0, label="Mohr-Coulomb, tension cut-off")
    plot.plot([-TENSION / 1e6] * 2, [-TENSION / 1e6, strength(-TENSION) / 1e6], color=figures.INK, linewidth=1.0)
    plot.plot(p3 / 1e6, p3 / 1e6, ":", color=figures.PALE, label="hydrostatic")
    plot.plot([p / 1e6 for p, _ in points], [p / 1e6 for _, p in points], "o", color=figures.FOUND, label="runs, shear")
    plot.plot([p / 1e6 for p, _ in torn], [p / 1e6 for _, p in torn], "s", color=figures.SECOND, label="runs, tension")
    plot.set(xlabel="$p_3$ (MPa, compression positive)", ylabel="$p_1$ (MPa)")
    plot.legend()
    case.save_figure(figure)
