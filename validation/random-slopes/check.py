"""Factors of safety of slopes of random joints against limit analysis by linear programming."""

import math

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_matrix

from suite import figures
from suite.case import DEFAULT_TOLERANCE, bisect

SEEDS = range(1, 13)
BASE, HEIGHT, TOE, CREST = 5.0, 10.0, 6.0, 14.0
WEIGHT = 2600 * 9.81  # N/m3


def slope(seed):
    """Polygon, traces and friction angle (degrees) of a slope."""
    random = np.random.default_rng(seed)
    edge = TOE + HEIGHT / math.tan(math.radians(random.uniform(55, 85)))
    polygon = [[0, 0], [edge + CREST, 0], [edge + CREST, BASE + HEIGHT], [edge, BASE + HEIGHT], [TOE, BASE], [0, BASE]]
    traces = []
    for dip, spacing in ((random.uniform(25, 60), random.uniform(1.5, 3.5)), (-random.uniform(40, 85), random.uniform(1.5, 3.5))):
        along = np.array([math.cos(math.radians(dip)), math.sin(math.radians(dip))])
        normal = np.array([-along[1], along[0]])
        count = int(1.2 * HEIGHT / spacing)
        for i in range(-count, count + 1):
            middle = np.array([edge, BASE + 0.5 * HEIGHT]) + normal * spacing * (i + random.uniform(-0.3, 0.3))
            traces.append([(middle - 40 * along).tolist(), (middle + 40 * along).tolist()])
    return polygon, traces, random.uniform(25, 42)


def area_and_centroid(corners):
    x, y = corners.T
    x_next, y_next = np.roll(x, -1), np.roll(y, -1)
    cross = x * y_next - x_next * y
    area = 0.5 * cross.sum()
    return area, np.array([((x + x_next) * cross).sum(), ((y + y_next) * cross).sum()]) / (6 * area)


def is_held(corners, width):
    """Whether an edge of the block lies on the base, the back or the foot."""
    after = np.roll(corners, -1, axis=0)
    return any((np.abs(corners[:, axis] - at) + np.abs(after[:, axis] - at) < 1e-6).any()
               for axis, at in ((1, 0.0), (0, width), (0, 0.0)))


class LimitAnalysis:
    """Unknowns: normal and shear force at both ends of each interface, on the block that the normal points into."""

    def __init__(self, corners, interfaces, width):
        free = [b for b, each in corners.items() if not is_held(each, width)]
        number = {b: i for i, b in enumerate(free)}
        entries, self.ends = [], 0
        properties = {b: area_and_centroid(corners[b]) for b in corners}
        for block_a, block_b, start, end in interfaces:
            if block_a not in number and block_b not in number:
                continue
            along = (end - start) / np.linalg.norm(end - start)
            normal = np.array([-along[1], along[0]])
            normal *= np.sign(normal @ (properties[block_a][1] - start))
            for point in (start, end):
                for k, direction in enumerate((normal, along)):
                    for block, sense in ((block_a, 1), (block_b, -1)):
                        if block in number:
                            arm, force = point - properties[block][1], sense * direction
                            for row, value in enumerate((*force, arm[0] * force[1] - arm[1] * force[0])):
                                entries.append((3 * number[block] + row, 2 * self.ends + k, value))
                self.ends += 1
        rows, columns, values = zip(*entries)
        self.balance = coo_matrix((values, (rows, columns)), shape=(3 * len(free), 2 * self.ends)).tocsr()
        self.loads = np.zeros(3 * len(free))
        for b in free:
            self.loads[3 * number[b] + 1] = properties[b][0] * WEIGHT / 1e5  # in 100 kN, for the solver's sake

    def stands(self, friction):
        """Whether forces within this coefficient of friction balance all blocks."""
        ends = np.arange(self.ends)
        rows = np.concatenate([2 * ends, 2 * ends, 2 * ends + 1, 2 * ends + 1])
        columns = np.concatenate([2 * ends + 1, 2 * ends, 2 * ends + 1, 2 * ends])
        values = np.repeat([1.0, -friction, -1.0, -friction], self.ends)
        limits = coo_matrix((values, (rows, columns)), shape=(2 * self.ends, 2 * self.ends)).tocsr()
        bounds = [(0, None), (None, None)] * self.ends
        found = linprog(np.zeros(2 * self.ends), A_ub=limits, b_ub=np.zeros(2 * self.ends), A_eq=self.balance, b_eq=self.loads,
                        bounds=bounds, method="highs")
        return found.status == 0


def polygons_of(run):
    """Corners of each block before loading, by its number."""
    blocks = run.blocks(0)
    return {int(b): blocks.points[cell] for b, cell in zip(blocks["block"], blocks.cells)}


def bound_of(run, width, friction):
    lines = run.interfaces(0)
    interfaces = [(int(a), int(b), *lines.points[cell]) for a, b, cell in zip(lines["block_a"], lines["block_b"], lines.cells)]
    analysis = LimitAnalysis(polygons_of(run), interfaces, width)
    return bisect(lambda factor: analysis.stands(friction / factor), 0.3, 6.0, 2e-4)[0]


def check(case):
    bounds, factors = [], []
    for seed in SEEDS:
        polygon, traces, angle = slope(seed)
        run = case.run(f"seed-{seed}", {"geometry.domain.polygon": polygon, "interfaces.joint.friction_angle": angle,
                                        "geometry.fractures": [{"name": f"joint {i}", "trace": trace, "interface": "joint"}
                                                               for i, trace in enumerate(traces)]})
        bounds.append(bound_of(run, polygon[1][0], math.tan(math.radians(angle))))
        factors.append(run.summary["factor_of_safety"])
    ratios = np.array(factors) / np.array(bounds)
    case.expect("factor over bound, largest of 12, defaults", 1.0, float(ratios.max()), DEFAULT_TOLERANCE)
    case.expect("factor over bound, median, defaults", 1.0, float(np.median(ratios)), 2e-3)
    case.expect_same("slopes more than 20 % below the bound", 0, int((ratios < 0.8).sum()))
    figure, (sketch, plot) = case.figure()
    for corners in polygons_of(run).values():
        figures.block(sketch, corners.tolist())
    ends = np.array([min(bounds), max(bounds)])
    plot.plot(ends, ends, color=figures.INK, linewidth=1.0, label="limit analysis")
    plot.plot(bounds, factors, "o", color=figures.FOUND, label="found")
    plot.set(xlabel="factor of the limit analysis", ylabel="factor of safety")
    plot.legend()
    case.save_figure(figure)
