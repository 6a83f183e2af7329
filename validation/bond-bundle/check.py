"""Load and displacement at every event of a bundle of bonds."""

import numpy as np

from suite import figures

STIFFNESS = 1e12
BLOCKS = 1.0 / 1e15  # H/E of both blocks, which stretch a little (a block has at most E = 1e15 Pa); width 1 m
BONDS = [(0.3, 1.5e6), (0.2, 0.5e6), (0.1, 2.0e6), (0.25, 0.8e6), (0.15, 1.1e6)]  # length (m), tensile strength (Pa)


def expected_events():
    """Per event, weakest bond first: displacement, force (N/m) before and after it at the same displacement."""
    events = []
    for _, strength in sorted(BONDS, key=lambda bond: bond[1]):
        before = sum(length for length, other in BONDS if other >= strength) * strength
        travel = strength / STIFFNESS + BLOCKS * before
        left = sum(length for length, other in BONDS if other > strength)
        after = travel / (BLOCKS + 1 / (STIFFNESS * left)) if left else 0.0
        events.append((travel, before, after))
    return events


def check(case):
    table = case.run("pull").equilibria
    travel, force = -table["axial_strain"] * 1.0, -table["axial_stress"] * 1.0  # width and height 1 m
    broken = table["cracks_tension"] + table["cracks_shear"]
    jumps = np.flatnonzero(np.diff(broken) > 0)
    case.expect_same("events, one bond each", [1] * len(BONDS), [int(n) for n in np.diff(broken)[jumps]])
    events = expected_events()
    if len(jumps) == len(events):
        case.expect_worst("displacement at events", [1e6 * e[0] for e in events], 1e6 * travel[jumps], 1e-6, "um")
        case.expect_worst("force before events", [e[1] / 1e6 for e in events], force[jumps] / 1e6, 1e-6, "MN/m")
        peak = max(e[1] for e in events)
        case.expect_worst("force after events over the peak", [e[2] / peak for e in events], force[jumps + 1] / peak, 1e-6, absolute=True)
        case.expect("peak", peak / 1e6, force.max() / 1e6, 1e-6, "MN/m")
    figure, (sketch, plot) = case.figure()
    figures.block(sketch, [(0, 0), (1, 0), (1, 0.4), (0, 0.4)])
    figures.block(sketch, [(0, 0.7), (1, 0.7), (1, 1.1), (0, 1.1)])
    start = 0.0
    for length, strength in BONDS:
        figures.line(sketch, [(start + length / 2, 0.4), (start + length / 2, 0.7)], linewidth=14 * length + 0.5, color=figures.SECOND)
        figures.label(sketch, (start + length / 2, 0.8), f"{strength / 1e6:g}", fontsize=7)
        start += length
    figures.label(sketch, (0.5, 0.95), "strengths (MPa)", fontsize=7)
    figures.smooth_support(sketch, (0, 0), (1, 0), 0.08)
    figures.arrow(sketch, (0.5, 1.13), (0.5, 1.4), "u", (0.1, 0))
    corners = [(0.0, 0.0)] + [corner for event in events for corner in ((event[0], event[1]), (event[0], event[2]))] + [(2.4e-6, 0.0)]
    plot.plot([1e6 * c[0] for c in corners], [c[1] / 1e6 for c in corners], color=figures.INK, linewidth=1.0, label="theory")
    plot.plot(1e6 * travel, force / 1e6, "o", color=figures.FOUND, label="run, each equilibrium")
    plot.set(xlabel="u (0.001 mm)", ylabel="force (MN/m)", xlim=(0, None), ylim=(0, None))
    plot.legend()
    case.save_figure(figure)
