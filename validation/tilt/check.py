"""The slope at which a block slides, in one run, from its histories."""

import math

import numpy as np

from suite import figures

FRICTION = 30.0
MASS, LENGTH = 4.0 * 1.0 * 2500, 4.0  # kg/m, m
SHEAR_STIFFNESS = 5e10


def direction(slope):
    return 10.0 * np.array([math.sin(math.radians(slope)), math.cos(math.radians(slope))])


def gravity(histories):
    """(along, onto) the plane at each row: linear over each stage."""
    ends = [direction(slope) for slope in (0.0, 0.0, 29.9, 30.1)]
    return np.array([(1 - share) * ends[int(stage)] + share * ends[int(stage) + 1]
                     for stage, share in zip(histories["stage"], histories["load_factor"])])


def slip_at_rest(along, onto):
    """Slip of a rigid block on three points (weights 1/6, 4/6, 1/6) under the forces T and N: points slip one by one, from the
    upper one, whose pressure is the smallest."""
    along, onto = MASS * along, MASS * onto
    arm = along * 0.5 / onto  # of N from the middle; the weight acts at half the height
    limits = onto / LENGTH * (1 + 6 * arm / LENGTH * np.array([-1, 0, 1])) * math.tan(math.radians(FRICTION))
    weights = np.array([1, 4, 1]) / 6 * LENGTH
    for slipping in range(3):
        traction = (along - (weights * limits)[:slipping].sum()) / weights[slipping:].sum()
        if traction <= limits[slipping]:
            return traction / SHEAR_STIFFNESS
    return math.inf


def check(case):
    results = {}
    for kinematics in ("affine", "rigid"):
        run = case.run(kinematics, {"analysis.kinematics": kinematics, "output.fields": False}, may_fail=True)
        histories = run.histories
        pull = gravity(histories)
        slope = np.degrees(np.arctan2(pull[:, 0], pull[:, 1]))
        slip = np.abs(histories["joint.slip"])
        at_rest = np.array([slip_at_rest(*row) for row in pull])
        case.expect(f"{kinematics}: slope half a step after the last row at rest", FRICTION,
                    1.5 * slope[-1] - 0.5 * slope[-2], 0.01, "deg", absolute=True)
        case.expect_same(f"{kinematics}: the run ends there, without equilibrium", ("no_equilibrium", "block"),
                         (run.summary["status"], run.summary["falling_blocks"][0]["block"]))
        rest = slice(1, None)
        normal, shear = histories["joint.normal_force"][rest], np.abs(histories["joint.shear_force"][rest])
        case.expect_worst(f"{kinematics}: N = W cos at rest", MASS * pull[rest, 1] / 1e3, normal / 1e3, 1e-6, "kN/m")
        case.expect_worst(f"{kinematics}: T = W sin at rest, over W", pull[rest, 0] / 10, shear / (10 * MASS), 1e-6, absolute=True)
        case.expect_worst(f"{kinematics}: slip at rest", 1e6 * at_rest[2:], 1e6 * slip[2:], 1e-6 if kinematics == "rigid" else 1e-3, "um")
        results[kinematics] = slope, slip
        run = case.run(kinematics, {"analysis.kinematics": kinematics, "output.fields": False}, may_fail=True, defaults=True)
        pull = gravity(run.histories)[run.history["balanced"] == 1]
        last = 1.5 * pull[-1, 0] / pull[-1, 1] - 0.5 * pull[-2, 0] / pull[-2, 1]
        case.expect_default(f"{kinematics}: tangent of that slope", math.tan(math.radians(FRICTION)), last)
    draw(case, results)


def draw(case, results):
    figure, (sketch, plot) = case.figure()
    angle = math.radians(25)
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])

    def at(*points):
        return [turn @ np.array(point) for point in points]

    figures.block(sketch, at((-1, -1), (5, -1), (5, 0), (-1, 0)))
    figures.block(sketch, at((0, 0), (4, 0), (4, 1), (0, 1)))
    figures.line(sketch, [turn @ np.array([5, -1]), turn @ np.array([5, -1]) + [-4, 0]], linestyle=":")
    figures.label(sketch, turn @ np.array([5, -1]) + [-2.6, 0.45], r"$\theta$")
    figures.arrow(sketch, turn @ np.array([2, 0.5]), turn @ np.array([2, 0.5]) + [0, -1.6], "W", (0.35, 0))
    for (kinematics, (slope, slip)), marker, colour in zip(results.items(), "os", (figures.FOUND, figures.SECOND)):
        style = {} if marker == "o" else {"markersize": 8, "markerfacecolor": "none"}
        plot.semilogy(slope[1:], np.maximum(slip[1:], 1e-12), marker, color=colour, label=f"{kinematics} block", **style)
    theta = np.linspace(0.1, 29.999, 300)
    plot.semilogy(theta, [slip_at_rest(*direction(value)) for value in theta], color=figures.INK, linewidth=1.0, label="at rest, three points")
    plot.axvline(FRICTION, color=figures.PALE, linestyle="--", linewidth=0.9)
    plot.set(xlabel=r"slope $\theta$ (deg)", ylabel="slip (m)", xlim=(0, 32))
    plot.legend()
    case.save_figure(figure)
