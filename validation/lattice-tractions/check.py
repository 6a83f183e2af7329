"""Tractions on the faces of the hexagons, and the mean stress of a hexagon from them (Love 1927, Weber 1966)."""

import math

import numpy as np

from suite import figures

D = 0.03
ROW = D * math.sqrt(3) / 2
CENTRE = (0.9075, 2 * ROW)  # of a hexagon in the middle of the strip


def tractions(ratio, angle):
    """(t_n, t_s) over the stress on a face whose normal is at `angle` (radians) to the load: docs/theory.md, eq. 21."""
    return 0.5 + np.cos(2 * angle) / (1 + ratio), np.sin(2 * angle) * ratio / (1 + ratio)


def middle_faces(run):
    """Blocks, faces, a hexagon in the middle, its six faces and its axial stress."""
    blocks, faces = run.blocks(), run.interfaces()
    hexagon = blocks.nearest(CENTRE)
    centre = blocks.middles()[hexagon]
    stress = blocks["stress_yy"][hexagon]
    own = np.flatnonzero(np.linalg.norm(faces.middles() - centre, axis=1) < 0.51 * D)
    assert len(own) == 6
    return blocks, faces, hexagon, own, stress


def love_weber(blocks, faces, hexagon, own):
    """Mean stress sym(sum f (x) x)/A of the hexagon from the tractions on its faces, [xx, yy, xy]."""
    centre = blocks.middles()[hexagon]
    total = np.zeros((2, 2))
    for face in own:
        start, end = faces.points[faces.cells[face]]
        along = (end - start) / np.linalg.norm(end - start)
        normal = np.array([along[1], -along[0]])  # of the block that the face's direction goes round, its side a
        arm = 0.5 * (start + end) - centre
        side = math.copysign(1.0, normal @ arm)
        force = side * faces.lengths()[face] * (faces["normal_traction"][face] * normal + faces["shear_traction"][face] * along)
        total += np.outer(force, arm)
    total = 0.5 * (total + total.T) / blocks.areas()[hexagon]
    return np.array([total[0, 0], total[1, 1], total[0, 1]])


def check(case):
    measured = {}
    for ratio in (0.1, 0.4, 1.0):
        overrides = {}
        for kind in ("bond", "joint"):
            overrides[f"interfaces.{kind}.shear_stiffness"] = ratio * 1e11
        blocks, faces, hexagon, own, stress = middle_faces(case.run(f"ratio-{ratio:g}", overrides))
        angle = faces.angles()[own] - 90.0  # between normal and load: -90 and +-30 degrees
        normal, shear = faces["normal_traction"][own] / stress, np.abs(faces["shear_traction"][own]) / abs(stress)
        measured[ratio] = (angle, normal, shear)
        expected = tractions(ratio, np.radians(angle))
        if ratio == 0.4:
            upright = np.abs(np.abs(angle) - 90) < 1
            assert upright.sum() == 2
            case.expect_worst("t_n/s on faces along the load, k_s/k_n 0.4", expected[0][upright], normal[upright], 1e-6)
            case.expect_worst("t_n/s on faces at 30 deg", expected[0][~upright], normal[~upright], 1e-6)
            case.expect_worst("|t_s|/s on faces at 30 deg", np.abs(expected[1])[~upright], shear[~upright], 1e-6)
        case.expect_worst(f"t_n/s and |t_s|/s, k_s/k_n {ratio:g}", np.append(expected[0], np.abs(expected[1])),
                          np.append(normal, shear), 1e-6, absolute=True)
        of_block = np.array([blocks[f"stress_{name}"][hexagon] for name in ("xx", "yy", "xy")])
        case.expect_worst(f"Love-Weber stress over s, k_s/k_n {ratio:g}", of_block / abs(stress),
                          love_weber(blocks, faces, hexagon, own) / abs(stress), 1e-6, absolute=True)
    draw(case, measured)


def draw(case, measured):
    figure, (sketch, plot) = case.figure()
    corners = np.radians(30 + 60 * np.arange(6))
    figures.block(sketch, np.transpose([np.cos(corners), np.sin(corners)]))
    for x in (-0.45, 0.45):
        figures.arrow(sketch, (x, 1.75), (x, 1.1))
        figures.arrow(sketch, (x, -1.75), (x, -1.1))
    figures.label(sketch, (0.0, 1.6), "s")
    across = math.sqrt(3) / 2
    figures.arrow(sketch, (0.5 * across, 0.75), (across, 1.5), "$t_n$", (0.2, 0), figures.SECOND)
    figures.arrow(sketch, (0.5 * across, 0.75), (1.15, 0.37), "$t_s$", (0.15, 0.15), figures.SECOND)
    figures.arrow(sketch, (across, -0.1), (1.5, -0.1), "tension", (0.25, 0.16), figures.SECOND)
    angle = np.linspace(-90, 90, 181)
    for colour, (ratio, (found_angle, normal, shear)) in zip((figures.THIRD, figures.FOUND, figures.SECOND), measured.items()):
        expected = tractions(ratio, np.radians(angle))
        plot.plot(angle, expected[0], color=colour, linewidth=1.0)
        plot.plot(angle, np.abs(expected[1]), "--", color=colour, linewidth=1.0)
        plot.plot(found_angle, normal, "o", color=colour, label=f"$t_n/s$, $k_s/k_n$ {ratio:g}")
        plot.plot(found_angle, shear, "s", color=colour, markerfacecolor="white", label=f"$|t_s|/s$, {ratio:g}")
    plot.set(xlabel="angle between the face's normal and the load (deg)", ylabel="traction over stress", xticks=range(-90, 91, 30))
    plot.legend(fontsize=7, loc="center left", bbox_to_anchor=(1, 0.5), title="lines: theory")
    case.save_figure(figure)
