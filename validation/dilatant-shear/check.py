"""Opening and normal stress of a joint that dilates as it slips."""

import math

import numpy as np

from suite import figures

PHI, PSI, NORMAL = math.radians(30), math.radians(10), 1e6
NORMAL_STIFFNESS, SHEAR_STIFFNESS = 1e14, 5e13
SPRING = 1 / (0.5 / 2e13 + 1 / 1e15 + 0.75 / 1e15)  # H/E of the column, the seam below it, H/E of slider and base


def joint_of(run):
    """Per load step of the shear stage: plastic slip, opening since the stage began, normal and shear stress."""
    start = int(run.history["step"][run.history["stage"] == 0][-1])
    rows = []
    for step in run.field_steps:
        if step < start:
            continue
        faces = run.interfaces(step)
        joint = faces.nearest((0.5, 0.5))
        rows.append([abs(faces["slip"][joint]), faces["gap"][joint], -faces["normal_traction"][joint], abs(faces["shear_traction"][joint])])
    slip, gap, normal, shear = np.array(rows).T
    return slip - shear / SHEAR_STIFFNESS, gap - gap[0], normal, shear


def check(case):
    free = joint_of(case.run("constant-stress"))
    plastic, opening, normal, shear = free
    slipped = plastic > 1e-9
    case.expect_worst("constant stress: opening over plastic slip = tan psi", math.tan(PSI), opening[slipped] / plastic[slipped], 1e-6)
    case.expect_worst("constant stress: shear stress at slip", NORMAL * math.tan(PHI) / 1e6, shear[slipped] / 1e6, 1e-6, "MPa")
    held = joint_of(case.run("constant-stiffness", scene="stiffness.yaml"))
    plastic, opening, normal, shear = held
    slipped = plastic > 1e-9
    rise = plastic[slipped] * math.tan(PSI) / (1 / SPRING + 1 / NORMAL_STIFFNESS)
    case.expect_worst("constant stiffness: rise of the normal stress", rise / 1e6, (normal[slipped] - normal[0]) / 1e6, 1e-6, "MPa")
    case.expect_worst("constant stiffness: shear over normal stress = tan phi", math.tan(PHI), shear[slipped] / normal[slipped], 1e-6)
    plastic, opening, normal, shear = joint_of(case.run("constant-stress", defaults=True))
    slipped = plastic > 2e-9  # the friction's rounding takes the first nanometre
    case.expect_default("constant stress: rate of opening over rate of plastic slip", math.tan(PSI),
                        np.diff(opening[slipped]) / np.diff(plastic[slipped]))
    case.expect_default("constant stress: shear stress at slip", NORMAL * math.tan(PHI) / 1e6, shear[slipped] / 1e6, "MPa")
    plastic, _, normal, shear = joint_of(case.run("constant-stiffness", scene="stiffness.yaml", defaults=True))
    case.expect_default("constant stiffness: shear over normal stress", math.tan(PHI), (shear / normal)[plastic > 1e-9])
    draw(case, free, held)


def draw(case, free, held):
    figure, (sketch, left, right) = case.figure(9.2, 3.2, plots=2, ratios=[0.7, 1, 1])
    figures.block(sketch, [(0, 0), (1, 0), (1, 0.5), (0, 0.5)])
    figures.block(sketch, [(0.12, 0.53), (1.12, 0.53), (1.12, 0.8), (0.12, 0.8)])
    figures.ground(sketch, (0, 0), (1, 0), 0.08)
    figures.arrow(sketch, (-0.25, 0.65), (0.1, 0.65), "u", (0, 0.1))
    figures.arrow(sketch, (0.62, 1.15), (0.62, 0.82), r"$\sigma_n$ or $K$", (0.3, 0))
    figures.label(sketch, (0.5, 0.42), r"$\varphi, \psi, k_n$")
    slip = np.linspace(0, 2e-7, 50)
    left.plot(1e6 * slip, 1e6 * slip * math.tan(PSI), color=figures.INK, linewidth=1.0, label=r"$u_p\,\tan\psi$")
    left.plot(1e6 * free[0], 1e6 * free[1], "o", color=figures.FOUND, label="run, constant stress")
    left.plot(1e6 * held[0], 1e6 * held[1], "s", color=figures.SECOND, label="run, constant stiffness")
    left.set(xlabel="plastic slip (0.001 mm)", ylabel="opening (0.001 mm)")
    left.legend()
    stress = held[2][0] + slip * math.tan(PSI) / (1 / SPRING + 1 / NORMAL_STIFFNESS)
    right.plot(1e6 * slip, stress / 1e6, color=figures.INK, linewidth=1.0, label="theory")
    right.plot(1e6 * slip, stress * math.tan(PHI) / 1e6, "--", color=figures.INK, linewidth=1.0)
    right.plot(1e6 * held[0], held[2] / 1e6, "s", color=figures.SECOND, label="normal stress, run")
    right.plot(1e6 * held[0], held[3] / 1e6, "s", color=figures.SECOND, markerfacecolor="white", label="shear stress, run")
    right.set(xlabel="plastic slip (0.001 mm)", ylabel="stress at constant stiffness (MPa)")
    right.legend()
    case.save_figure(figure)
