"""One house style for all figures, and the few shapes that sketches are made of."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

INK = "#1a1a1a"
ROCK = "#e4ddd0"
EDGE = "#6b6355"
FOUND = "#b3372b"
SECOND = "#2a6f97"
THIRD = "#5f8d4e"
PALE = "#9a9a9a"
DOTS_PER_INCH = 110

plt.rcParams.update({
    "font.family": "DejaVu Sans", "font.size": 8.5, "axes.titlesize": 9, "axes.labelsize": 8.5, "legend.fontsize": 8,
    "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": INK, "axes.linewidth": 0.8,
    "axes.grid": True, "grid.color": "#e6e6e6", "grid.linewidth": 0.6, "axes.axisbelow": True, "legend.frameon": False,
    "lines.linewidth": 1.4, "lines.markersize": 4.5, "figure.constrained_layout.use": True,
})


def panels(width, height, sketch, plots=1, ratios=None):
    """(figure, panels): the first panel is that of the sketch, if there is one."""
    n = plots + (1 if sketch else 0)
    ratios = ratios or ([0.62] if sketch else []) + [1.0] * plots
    figure, axes = plt.subplots(1, n, figsize=(width, height), gridspec_kw={"width_ratios": ratios}, squeeze=False)
    axes = list(axes[0])
    if sketch:
        axes[0].set_aspect("equal")
        axes[0].axis("off")
    return figure, axes


def save(figure, path):
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=DOTS_PER_INCH, metadata={"Software": None})
    plt.close(figure)


def block(axes, corners, **style):
    axes.add_patch(plt.Polygon(corners, closed=True, **{"facecolor": ROCK, "edgecolor": EDGE, "linewidth": 1.0, **style}))
    axes.update_datalim(corners)
    axes.autoscale_view()


def line(axes, points, **style):
    x, y = np.transpose(points)
    axes.plot(x, y, **{"color": INK, "linewidth": 1.2, **style})


def arrow(axes, start, end, text="", offset=(0.0, 0.0), colour=FOUND, style="-|>"):
    axes.annotate("", xy=end, xytext=start, arrowprops={"arrowstyle": style, "color": colour, "linewidth": 1.2,
                                                       "shrinkA": 0, "shrinkB": 0})
    axes.update_datalim([start, end])
    axes.autoscale_view()
    if text:
        label(axes, (0.5 * (start[0] + end[0]) + offset[0], 0.5 * (start[1] + end[1]) + offset[1]), text, color=colour)


def label(axes, place, text, **style):
    axes.text(*place, text, **{"ha": "center", "va": "center", "fontsize": 8, **style})


def ground(axes, start, end, depth, n=12):
    """Hatching on the right of the line from start to end: a fixed support."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    along = (end - start) / np.linalg.norm(end - start)
    away = np.array([along[1], -along[0]])
    line(axes, [start, end], linewidth=1.6)
    for s in np.linspace(0.0, 1.0, n + 1)[1:]:
        foot = start + s * (end - start)
        line(axes, [foot, foot + depth * (away - along)], linewidth=0.6)
    axes.update_datalim([start + depth * away, end + depth * away])


def smooth_support(axes, start, end, size, n=4):
    """Rollers on the right of the line from start to end."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    along = (end - start) / np.linalg.norm(end - start)
    away = np.array([along[1], -along[0]])
    for s in (np.arange(n) + 0.5) / n:
        axes.add_patch(plt.Circle(start + s * (end - start) + 0.5 * size * away, 0.5 * size, facecolor="white",
                                  edgecolor=INK, linewidth=0.8))
    line(axes, [start + size * away, end + size * away], linewidth=1.2)
