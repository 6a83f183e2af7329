"""Stiffness, peak and residual strength in a shear box."""

import math

import numpy as np

from suite import figures

C, PHI, NORMAL, SHEAR_STIFFNESS = 1e6, math.radians(30), 1e6, 0.5e13
PEAK = C + NORMAL * math.tan(PHI)
RESIDUAL = NORMAL * math.tan(PHI)


def check(case):
    run = case.run("shear")
    table = run.equilibria
    shear = table["stage"] == 1
    force = table["axial_stress"][shear]  # over the height of the box, 1 m, which is also the interface's length
    travel = table["axial_strain"][shear] * 1.0
    cracks = (table["cracks_tension"] + table["cracks_shear"])[shear]
    before, after = cracks == 0, cracks > 0
    bonded = [faces for faces in map(run.interfaces, run.field_steps) if faces["bonded"][0] and abs(faces["slip"][0]) > 1e-12]
    case.expect_worst("shear traction over slip = k_s, load steps before the peak", SHEAR_STIFFNESS / 1e12,
                      [abs(faces["shear_traction"][0] / faces["slip"][0]) / 1e12 for faces in bonded], 1e-6, "TPa/m")
    case.expect("peak", PEAK / 1e6, force[before].max() / 1e6, 1e-6, "MPa")
    case.expect("residual", RESIDUAL / 1e6, force[after][-1] / 1e6, 1e-6, "MPa")
    plain = case.run("shear", defaults=True).equilibria
    bonded_rows = plain["cracks_tension"] + plain["cracks_shear"] == 0
    case.expect_default("peak and residual", [PEAK / 1e6, RESIDUAL / 1e6],
                        [plain["axial_stress"][bonded_rows].max() / 1e6, plain["axial_stress"][-1] / 1e6], "MPa")
    last = run.interfaces()
    case.expect("traction on the interface at the end", RESIDUAL / 1e6, abs(last["shear_traction"][0]) / 1e6, 1e-6, "MPa")
    case.expect_same("mode of the crack", "shear", str(run.cracks["mode"][0]))
    draw(case, travel, force)


def draw(case, travel, force):
    figure, (sketch, plot) = case.figure()
    figures.block(sketch, [(0, 0), (1, 0), (1, 0.5), (0, 0.5)])
    figures.block(sketch, [(0.12, 0.5), (1.12, 0.5), (1.12, 1), (0.12, 1)])
    figures.ground(sketch, (0, 0), (1, 0), 0.08)
    for x in (0.3, 0.6, 0.9):
        figures.arrow(sketch, (x, 1.3), (x, 1.02))
    figures.label(sketch, (0.62, 1.4), "1 MPa", color=figures.FOUND)
    figures.arrow(sketch, (-0.25, 0.75), (0.1, 0.75), "u", (0, 0.1))
    slip = np.array([0, PEAK / SHEAR_STIFFNESS, PEAK / SHEAR_STIFFNESS, travel.max()])
    plot.plot(1e6 * slip, np.array([0, PEAK, RESIDUAL, RESIDUAL]) / 1e6, color=figures.INK, linewidth=1.0, label="theory")
    plot.plot(1e6 * travel, force / 1e6, "o", color=figures.FOUND, markersize=3.5, label="run, each equilibrium")
    plot.set(xlabel="u (0.001 mm)", ylabel="shear stress (MPa)", xlim=(0, None), ylim=(0, 1.8))
    plot.legend()
    case.save_figure(figure)
