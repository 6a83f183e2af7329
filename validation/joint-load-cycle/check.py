"""The three slopes of a block with a slipping joint in a load cycle."""

import math

import numpy as np

from suite import figures

E, NU, KN, KS, PHI = 10e9, 0.25, 50e9, 25e9, math.radians(15)
WIDTH = HEIGHT = 1.0
LAME = E * NU / ((1 + NU) * (1 - 2 * NU))
SHEAR = E / (2 * (1 + NU))


class Body:
    """The uniform solution: strains, closure and slip of the joint for a travel of the platen, with its plastic slip.

    Upper left wedge u = (e_x x, -d + e_y (y - H)), lower right wedge u = (e_x (x - W), e_y y): across the joint the
    displacement jumps by (e_x W, -d - e_y H), everywhere the same. Tension positive.
    """

    def __init__(self):
        length = math.hypot(WIDTH, HEIGHT)
        self.tangent = np.array([WIDTH, HEIGHT]) / length
        self.normal = np.array([-HEIGHT, WIDTH]) / length
        self.plastic = 0.0

    def stress(self, strain):
        return np.array([(LAME + 2 * SHEAR) * strain[0] + LAME * strain[1], LAME * strain[0] + (LAME + 2 * SHEAR) * strain[1]])

    def equations(self, strain, plastic, travel):
        """(closure, slip) residuals, and traction (t_n, t_s) on the joint: all linear in their arguments."""
        stress = self.stress(strain)
        jump = np.array([strain[0] * WIDTH, -travel - strain[1] * HEIGHT])
        t_n = (stress * self.normal**2).sum()
        t_s = (stress * self.normal * self.tangent).sum()
        return np.array([self.normal @ jump - t_n / KN, self.tangent @ jump - t_s / KS - plastic]), t_n, t_s

    def solve(self, travel, direction):
        """Strains and plastic slip; direction 0: no further slip, +-1: sliding with the shear traction of that sign."""

        def residual(unknown):
            strain, plastic = unknown[:2], unknown[2]
            gaps, t_n, t_s = self.equations(strain, plastic, travel)
            last = plastic - self.plastic if direction == 0 else (t_s + direction * t_n * math.tan(PHI)) / KS
            return np.append(gaps, last)

        start = residual(np.zeros(3))
        matrix = np.transpose([residual(column) - start for column in np.eye(3)])
        return np.linalg.solve(matrix, -start)

    def advance(self, travel):
        """Stress on the platen (compression positive) and whether the joint slips."""
        unknown = self.solve(travel, 0)
        _, t_n, t_s = self.equations(unknown[:2], unknown[2], travel)
        slips = abs(t_s) > -t_n * math.tan(PHI)
        if slips:
            unknown = self.solve(travel, math.copysign(1.0, t_s))
            self.plastic = unknown[2]
        return -self.stress(unknown[:2])[1], slips


def check(case):
    history = case.run("cycle").history
    travel = history["axial_strain"] * HEIGHT
    body = Body()
    expected, slips = zip(*[body.advance(value) for value in travel])
    expected, slips = np.array(expected), np.array(slips)
    found = history["axial_stress"]
    phase = np.where(history["stage"] == 0, 0, np.where(slips, 2, 1))
    phase[0] = -1
    for number, name in enumerate(("loading, with slip", "unloading, without slip", "unloading, with reverse slip")):
        of_phase = phase == number
        if number == 1:
            of_phase[np.flatnonzero(of_phase)[0] - 1] = True  # from the turning point on
        wanted, got = (np.polyfit(travel[of_phase], stress[of_phase], 1)[0] / 1e9 for stress in (expected, found))
        case.expect(f"slope, {name}", wanted, got, 1e-6, "GPa/m")
    case.expect_worst("stress on the platen over its largest, all load steps", expected / expected.max(), found / expected.max(), 1e-6,
                      absolute=True)
    by_default = case.run("cycle", defaults=True).history["axial_stress"]
    case.expect_default("largest and least stress on the platen", [expected.max() / 1e3, expected[-1] / 1e3],
                        [by_default.max() / 1e3, by_default[-1] / 1e3], "kPa")
    draw(case, travel, expected, found)


def draw(case, travel, expected, found):
    figure, (sketch, plot) = case.figure()
    figures.block(sketch, [(0, 0), (1, 1), (0, 1)])
    figures.block(sketch, [(0, 0), (1, 0), (1, 1)])
    figures.smooth_support(sketch, (0, 0), (1, 0), 0.07)
    figures.smooth_support(sketch, (1, 0), (1, 1), 0.07)
    figures.smooth_support(sketch, (0, 1), (0, 0), 0.07)
    figures.arrow(sketch, (0.5, 1.35), (0.5, 1.02), "d", (0.12, 0), style="<|-|>")
    figures.label(sketch, (0.72, 0.5), r"$k_n, k_s, \varphi$")
    plot.plot(1e9 * travel, expected, color=figures.INK, linewidth=1.0, label="theory")
    plot.plot(1e9 * travel, found, "o", color=figures.FOUND, markersize=3.5, label="run")
    plot.set(xlabel="travel d of the platen (nm)", ylabel="stress on the platen (Pa)")
    plot.legend()
    case.save_figure(figure)
