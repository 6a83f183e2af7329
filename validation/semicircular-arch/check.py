"""Smallest thickness of a semicircular arch of voussoirs."""

import math

import numpy as np

from suite import figures
from suite.case import bisect, order_of_convergence

RADIUS = 10.0
CHORDS = 8  # of each arc of a voussoir


def voussoirs(n, thickness):
    """Corners of n voussoirs of an arch of mean radius 1, counter-clockwise from the right springing."""
    inner, outer = 1 - thickness / 2, 1 + thickness / 2
    result = []
    for k in range(n):
        angles = [math.pi * (k + i / CHORDS) / n for i in range(CHORDS + 1)]
        result.append([(outer * math.cos(a), outer * math.sin(a)) for a in angles] +
                      [(inner * math.cos(a), inner * math.sin(a)) for a in reversed(angles)])
    return result


def area_and_centre(corners):
    """(area, x of the centroid)."""
    area = moment = 0.0
    for (x0, y0), (x1, y1) in zip(corners, corners[1:] + corners[:1]):
        cross = x0 * y1 - x1 * y0
        area += cross / 2
        moment += (x0 + x1) * cross / 6
    return area, moment / area


def bounds(n, thickness):
    """Rows (a, b, c) of a H + b M <= c: a thrust H at the height M/H of the crown stays within all joints of the right half.

    The part of the arch between the crown and a joint has the weight w at x: moments about the joint's inner end
    (x_i, y_i) ask for M - H y_i >= w (x_i - x), those about its outer end (x_o, y_o) for M - H y_o <= w (x_o - x).
    """
    rows = [(-(1 + thickness / 2), 1.0, 0.0), (1 - thickness / 2, -1.0, 0.0)]
    weight = moment = 0.0
    for k, corners in enumerate(reversed(voussoirs(n, thickness)[:n // 2])):
        area, centre = area_and_centre(corners)
        weight += area
        moment += area * centre
        angle = math.pi / 2 - (k + 1) * math.pi / n
        for radius, side in ((1 - thickness / 2, -1.0), (1 + thickness / 2, 1.0)):
            x, y = radius * math.cos(angle), radius * math.sin(angle)
            rows.append((-side * y, side, side * (weight * x - moment)))
    return rows


def thrust(n, thickness):
    """(H, M) of a thrust line within the arch, None where there is none. Corners of a region in the plane of H and M."""
    rows = bounds(n, thickness)
    for i, (a, b, c) in enumerate(rows):
        for d, e, f in rows[:i]:
            determinant = a * e - d * b
            if abs(determinant) < 1e-14:
                continue
            h, m = (c * e - f * b) / determinant, (a * f - d * c) / determinant
            if h > 0 and all(p * h + q * m <= r + 1e-12 for p, q, r in rows):
                return h, m
    return None


def smallest_thickness(n):
    """t/R of rigid voussoirs without tension and slip."""
    low, high = bisect(lambda thickness: thrust(n, thickness) is None, 0.05, 0.2, 1e-10)
    return 0.5 * (low + high)


def hinge(n):
    """Angle from the crown of the joint at whose inner end the last thrust line lies."""
    thickness = smallest_thickness(n) + 1e-9
    h, m = thrust(n, thickness)
    slack = [r - p * h - q * m for p, q, r in bounds(n, thickness)[2::2]]
    return 180.0 / n * (1 + int(np.argmin(slack)))


def blocks(n, thickness):
    """Springings and voussoirs as the scene's geometry.blocks."""
    inner, outer = RADIUS * (1 - thickness / 2), RADIUS * (1 + thickness / 2)
    springings = [{"name": name, "polygon": [[side * x, y] for x, y in ((inner, 0), (outer, 0), (outer, -1), (inner, -1))],
                   "support": "fixed"} for name, side in (("right", 1), ("left", -1))]
    return springings + [{"polygon": [[round(RADIUS * x, 12), round(RADIUS * y, 12)] for x, y in corners]}
                         for corners in voussoirs(n, thickness)]


def found_thickness(case, n, stiffness, expected, defaults=False):
    def falls(thickness):
        return not case.run(f"n-{n}-k-{stiffness:g}-{thickness:.7f}", {
            "geometry.blocks": blocks(n, thickness), "interfaces.joint.normal_stiffness": stiffness,
            "interfaces.joint.shear_stiffness": stiffness, "output.fields": False}, may_fail=True, defaults=defaults).balanced

    low, high = bisect(falls, 0.99 * expected, 1.04 * expected, 1e-5)
    return 0.5 * (low + high)


def check(case):
    numbers, stiffnesses = [20, 12], np.array([1e9, 1e10, 1e11])
    expected = {n: smallest_thickness(n) for n in numbers}
    case.expect("rigid voussoirs, N = 20: own t/R against the published one", 0.10746, expected[20], 1e-4, digits=6)
    case.expect("rigid voussoirs, N = 100: own t/R against Milankovitch", 0.1075, smallest_thickness(100), 5e-4, digits=6)
    found = {n: np.array([found_thickness(case, n, k, expected[n]) for k in stiffnesses]) for n in numbers}
    for n in numbers:
        case.expect(f"smallest t/R, N = {n}, k_n {stiffnesses[-1]:g} Pa/m", expected[n], found[n][-1], 5e-3, digits=6)
    for n in (8, 12, 16, 20):
        thickness = smallest_thickness(n)
        case.expect_default(f"smallest t/R, N = {n}", thickness, found_thickness(case, n, stiffnesses[-1], thickness, True), digits=6)
    draw(case, stiffnesses, expected, found)


def draw(case, stiffnesses, expected, found):
    figure, (sketch, plot) = case.figure()
    thickness = expected[20]
    for corners in voussoirs(20, thickness):
        figures.block(sketch, corners)
    for side in (-1, 1):
        inner, outer = sorted((side * (1 - thickness / 2), side * (1 + thickness / 2)))
        figures.ground(sketch, (inner - 0.05, 0), (outer + 0.05, 0), 0.05, 4)
    h, m = thrust(20, thickness + 1e-9)
    points = thrust_line(20, thickness, h, m)
    figures.line(sketch, points, color=figures.FOUND)
    figures.line(sketch, [(-x, y) for x, y in points], color=figures.FOUND)
    angle = math.radians(hinge(20))
    for place in ((0, 1 + thickness / 2), (1 + thickness / 2, 0), (-1 - thickness / 2, 0)):
        sketch.plot(*place, "o", color=figures.SECOND)
    for side in (-1, 1):
        sketch.plot(side * (1 - thickness / 2) * math.sin(angle), (1 - thickness / 2) * math.cos(angle), "o", color=figures.SECOND)
    figures.label(sketch, (0, 0.45), f"thrust line and\nhinges, N = 20\n(at {hinge(20):.0f}° from the crown)")
    for n, marker, colour in ((20, "o", figures.FOUND), (12, "s", figures.SECOND)):
        errors = np.abs(found[n] / expected[n] - 1)
        plot.loglog(stiffnesses, errors, marker + "-", color=colour,
                    label=f"N = {n}: {expected[n]:.5f}, order {-order_of_convergence(stiffnesses, errors):.2f}")
    plot.axhline(5e-3, color=figures.PALE, linestyle="--", linewidth=0.9)
    figures.label(plot, (4e10, 6.2e-3), "tolerance", color=figures.PALE)
    plot.set(xlabel="$k_n$ (Pa/m)", ylabel="error of the smallest t/R")
    plot.legend()
    case.save_figure(figure)


def thrust_line(n, thickness, h, m):
    """Where the thrust crosses the joints of the right half, from the crown."""
    points = [(0.0, m / h)]
    weight = moment = 0.0
    for k, corners in enumerate(reversed(voussoirs(n, thickness)[:n // 2])):
        area, centre = area_and_centre(corners)
        weight += area
        moment += area * centre
        angle = math.pi / 2 - (k + 1) * math.pi / n
        radius = (m + moment) / (weight * math.cos(angle) + h * math.sin(angle))  # M - H y = w x - moment on the joint
        points.append((radius * math.cos(angle), radius * math.sin(angle)))
    return points
