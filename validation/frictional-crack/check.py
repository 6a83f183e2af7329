"""Slip along a closed crack in a wide plate, at three sizes of hexagons."""

import math

import numpy as np

from suite import figures
from suite.case import order_of_convergence

E, NU, PHI, PSI, HALF_LENGTH, STRESS = 25e9, 0.25, math.radians(30), math.radians(20), 1.0, 100e6
HEALED = 1.5  # half-length of the cut, of which the crack is the part in the middle
LOAD = 1e6  # of the runs: the body is linear, and small strains are wanted
ALONG = np.array([math.sin(PSI), math.cos(PSI)])
NORMAL_TRACTION = -STRESS * math.sin(PSI) ** 2
LARGEST_SLIP = 4 * (1 - NU**2) / E * STRESS * math.sin(PSI) * (math.cos(PSI) - math.sin(PSI) * math.tan(PHI)) * HALF_LENGTH


def scene_of(n):
    """Hexagons of b/n: the crack begins and ends in the middle of a flat between two centres of its row."""
    points = [(along * HALF_LENGTH * ALONG).tolist() for along in (-HEALED, -1, 1, HEALED)]
    return {"geometry.fractures.0.trace": points[1:3], "geometry.fractures.1.trace": points[:2],
            "geometry.fractures.2.trace": points[2:], "geometry.tessellation.hexagons.spacing": HALF_LENGTH / (n + 0.5)}


def crack_of(run):
    """Place along the crack, slip and normal traction of its pieces, for the stress of the problem."""
    faces = run.interfaces()
    own = (faces["mapped_fracture"] >= 0) & (np.abs(faces.middles() @ ALONG) < HALF_LENGTH)
    place = faces.middles()[own] @ ALONG
    order = np.argsort(place)
    return place[order], (np.abs(faces["slip"][own]) * STRESS / LOAD)[order], (faces["normal_traction"][own] * STRESS / LOAD)[order]


def theory(place):
    return LARGEST_SLIP * np.sqrt(np.maximum(1 - (place / HALF_LENGTH) ** 2, 0))


def check(case):
    counts = (4, 8, 16)
    profiles = [crack_of(case.run(f"n-{n}", scene_of(n))) for n in counts]
    slips = [slip.max() for _, slip, _ in profiles]
    place, _, normal = profiles[-1]
    finest = HALF_LENGTH / (counts[-1] + 0.5)
    case.expect(f"largest slip, d = b/{counts[-1] + 0.5:g}", LARGEST_SLIP * 1e3, slips[-1] * 1e3, 2e-2, "mm", digits=5)
    middle = int(np.argmin(np.abs(place)))
    case.expect("normal traction in the middle", NORMAL_TRACTION / 1e6, normal[middle] / 1e6, 2e-2, "MPa", digits=5)
    plain = crack_of(case.run(f"n-{counts[-1]}", scene_of(counts[-1]), defaults=True))[1].max()
    case.expect("largest slip, defaults, against the same net with tight settings", slips[-1] * 1e3, plain * 1e3, 5e-3, "mm", digits=5)
    draw(case, [HALF_LENGTH / (n + 0.5) for n in counts], profiles, slips, finest)


def draw(case, sizes, profiles, slips, finest):
    figure, (sketch, left, right) = case.figure(9.4, 3.2, plots=2, ratios=[0.6, 1, 1])
    figures.block(sketch, [(-2, -2.5), (2, -2.5), (2, 2.5), (-2, 2.5)])
    figures.line(sketch, [-1.2 * ALONG, 1.2 * ALONG], color=figures.SECOND, linewidth=2)
    figures.line(sketch, [(0, -1.4), (0, 1.4)], linestyle=":")
    figures.label(sketch, (0.22, 1.45), r"$\psi$")
    figures.label(sketch, (0.8, 0.2), "2b", color=figures.SECOND)
    for x in (-1.2, 0, 1.2):
        figures.arrow(sketch, (x, 3.3), (x, 2.55))
        figures.arrow(sketch, (x, -3.3), (x, -2.55))
    line = np.linspace(-1, 1, 300)
    left.plot(line, 1e3 * theory(line), color=figures.INK, linewidth=1.0, label="theory")
    for colour, marker, (place, slip, _), size in zip((figures.THIRD, figures.SECOND, figures.FOUND), "^so", profiles, sizes):
        left.plot(place, 1e3 * slip, marker, color=colour, markersize=3.5, label=f"d = b/{1 / size:g}")
    left.set(xlabel="place along the crack / b", ylabel="slip (mm)", ylim=(0, None))
    left.legend()
    errors = [abs(slip / LARGEST_SLIP - 1) for slip in slips]
    right.loglog(sizes, errors, "o-", color=figures.FOUND, label=f"largest slip, order {order_of_convergence(sizes, errors):.2f}")
    right.axhline(2e-2, color=figures.PALE, linestyle=":", linewidth=0.9)
    right.set(xlabel="d / b", ylabel="error")
    right.legend()
    case.save_figure(figure)
