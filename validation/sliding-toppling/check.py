"""Rest, sliding and toppling of a block over slope and shape."""

import math

import numpy as np

from suite import figures

FRICTION = 30.0
MARKS = {"at rest": ("o", figures.THIRD), "slides": ("s", figures.SECOND), "topples": ("^", figures.FOUND)}


def theory(slope, aspect):
    """How the block begins to move; both where both conditions are met."""
    slides = slope > FRICTION
    topples = aspect < math.tan(math.radians(slope))
    return "both" if slides and topples else "slides" if slides else "topples" if topples else "at rest"


def found_mode(run):
    """How the block moves where no equilibrium is found: along its base alone, or turning too."""
    falling = run.summary["falling_blocks"]
    if not falling:
        return "at rest"
    return "topples" if falling[0]["turn"] else "slides"


def check(case):
    results = modes(case)
    by_default = modes(case, defaults=True)
    different = [key for key, mode in by_default.items() if mode != results[key] and theory(*key) != "both"]
    case.expect_same("slopes and shapes with another verdict, defaults", [], different)
    for mode in ("at rest", "slides", "topples", "both"):
        points = [key for key in results if theory(*key) == mode]
        allowed = ("slides", "topples") if mode == "both" else (mode,)
        right = sum(results[key] in allowed for key in points)
        name = "slides or topples, where both can happen" if mode == "both" else mode
        case.expect_same(f"blocks of {len(points)}: {name}", len(points), right)
    draw(case, results)


def modes(case, defaults=False):
    results = {}
    for slope in (10, 17, 24, 28, 32, 36, 43, 50):
        for aspect in (0.15, 0.25, 0.35, 0.5, 0.7, 0.9, 1.2):
            angle = math.radians(slope)
            run = case.run(f"slope-{slope}-aspect-{aspect:g}", {
                "analysis.gravity": [10 * math.sin(angle), -10 * math.cos(angle)],
                "geometry.domain.polygon": [[-1, -1], [aspect + 2, -1], [aspect + 2, 0], [aspect, 0], [aspect, 1], [0, 1], [0, 0], [-1, 0]],
                "geometry.fractures.0.trace": [[0, 0], [aspect, 0]]}, may_fail=True, defaults=defaults)
            results[slope, aspect] = found_mode(run)
    return results


def draw(case, results):
    figure, (sketch, plot) = case.figure()
    angle = math.radians(25)
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])

    def at(*points):
        return [turn @ np.array(point) for point in points]

    figures.block(sketch, at((-0.8, -0.4), (1.8, -0.4), (1.8, 0), (-0.8, 0)))
    figures.block(sketch, at((0, 0), (0.6, 0), (0.6, 1.2), (0, 1.2)))
    figures.ground(sketch, *at((-0.8, -0.4), (1.8, -0.4)), 0.12)
    centre = turn @ np.array([0.3, 0.6])
    figures.arrow(sketch, centre, centre + [0, -0.8], "W", (0.12, 0.1))
    figures.label(sketch, turn @ np.array([0.3, 1.35]), "b")
    figures.label(sketch, turn @ np.array([-0.15, 0.6]), "h")
    slope = np.linspace(5, 55, 200)
    plot.plot(slope, np.tan(np.radians(slope)), color=figures.INK, linewidth=1.0)
    plot.axvline(FRICTION, color=figures.INK, linewidth=1.0)
    for mode, (marker, colour) in MARKS.items():
        points = [key for key, value in results.items() if value == mode]
        plot.plot([p[0] for p in points], [p[1] for p in points], marker, linestyle="none", color=colour, label=f"run: {mode}")
    for place, text in (((13, 1.2), "rest"), ((52, 1.42), "slides"), ((12, 0.07), "topples"), ((46, 0.07), "slides and topples")):
        figures.label(plot, place, text, color=figures.PALE)
    plot.set(xlabel="slope (deg)", ylabel="b / h", xlim=(5, 55), ylim=(0, 1.5))
    plot.legend(loc="center left", bbox_to_anchor=(1, 0.5))
    case.save_figure(figure)
