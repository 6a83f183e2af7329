"""Pictures with matplotlib. Axes are in MPa, per cent and m."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError

if TYPE_CHECKING:
    from pathlib import Path

    from .fields import Fields
    from .results import Results

_TENSION, _SHEAR, _SLIDING, _FRACTURE = "#c8102e", "#1f4e9c", "#e69f00", "#222222"
_MEGAPASCAL = ("sigma_1", "sigma_3", "stress_xx", "stress_xy", "stress_yy")


def axes(ax: Any) -> Any:
    """`ax`, or the Axes of a new figure."""
    if ax is not None:
        return ax
    try:
        import matplotlib.pyplot as plt
    except ImportError as error:
        from .errors import missing

        raise missing("matplotlib", "a plot") from error
    return plt.subplots(constrained_layout=True)[1]


def draw_curve(results: Results, ax: Any, label: str | None) -> Any:
    """Every balanced equilibrium as a line, load steps as points (hollow where unbalanced), the peak."""
    ax = axes(ax)
    fine = results.equilibria[results.equilibria["balanced"]]
    (line,) = ax.plot(100.0 * fine["axial_strain"], 1e-6 * fine["differential_stress"], lw=1.2, label=label)
    rows = results.history
    for balanced, face in ((True, line.get_color()), (False, "white")):
        part = rows[rows["balanced"] == balanced]
        if len(part):
            ax.plot(100.0 * part["axial_strain"], 1e-6 * part["differential_stress"], "o", ms=3, color=line.get_color(), mfc=face)
    if results.summary.get("peak_stress") is not None:
        peak = results.peak
        ax.plot(100.0 * peak["axial_strain"], 1e-6 * peak["differential_stress"], "v", color=line.get_color())
    ax.set(xlabel="axial strain (%)", ylabel="differential stress (MPa)", title="" if label else results.title)
    if label:
        ax.legend()
    return ax


def draw_fields(fields: Fields, field: str, scale: float, ax: Any) -> Any:
    from matplotlib.collections import LineCollection, PolyCollection

    ax = axes(ax)
    values, name = _values(fields, field)
    blocks = PolyCollection(fields.deformed(scale), array=values, cmap="viridis", edgecolors="#00000022", linewidths=0.3)
    ax.add_collection(blocks)
    ax.figure.colorbar(blocks, ax=ax, label=name)
    faces = fields.interfaces
    broken = ~faces["bonded"]
    kinds = ((broken & (faces["crack"] == ""), _FRACTURE, 1.4), (broken & (faces["state"] == "sliding"), _SLIDING, 1.0),
             (faces["crack"] == "tension", _TENSION, 1.2), (faces["crack"] == "shear", _SHEAR, 1.2))
    lines = fields.interface_lines(scale)
    for chosen, colour, width in kinds:
        ax.add_collection(LineCollection(lines[chosen], colors=colour, linewidths=width))
    _finish_map(ax)
    ax.set_title(f"load step {fields.step}" + (f", displacements times {scale:g}" if scale != 1.0 else ""))
    return ax


def animate(states: list[Fields], path: Path, field: str, scale: float, fps: float) -> None:
    """The states one after the other, all with the colours and the window of their whole range."""
    import matplotlib.pyplot as plt
    from matplotlib import animation

    if path.suffix == ".gif":
        writer: Any = animation.PillowWriter(fps=fps)
    elif not animation.FFMpegWriter.isAvailable():
        raise InputError(f"{path}: expected a .gif, or the program ffmpeg for another kind of film, found none")
    else:
        writer = animation.FFMpegWriter(fps=fps)
    values = np.concatenate([_values(state, field)[0] for state in states])
    corners = np.concatenate([corner for state in states for corner in state.deformed(scale)])
    low, high = corners.min(axis=0), corners.max(axis=0)
    figure = plt.figure(figsize=(6.4, 6.4), layout="constrained")
    try:
        with writer.saving(figure, str(path), dpi=100):
            for state in states:
                figure.clear()
                ax = draw_fields(state, field, scale, figure.add_subplot())
                ax.collections[0].set_clim(*np.percentile(values, (0.5, 99.5)))
                ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
                writer.grab_frame()
    finally:
        plt.close(figure)


def _values(fields: Fields, field: str) -> tuple[np.ndarray, str]:
    if field == "displacement":
        return np.hypot(*fields.displacement.T), "displacement (m)"
    names = fields.blocks.dtype.names or ()
    if field not in names:
        from difflib import get_close_matches

        near = get_close_matches(field, names, 1)
        raise InputError(f"field: expected displacement or one of {', '.join(names)}, found '{field}'"
                         + (f"; did you mean '{near[0]}'?" if near else ""))
    values = fields.blocks[field]
    return (1e-6 * values, f"{field} (MPa)") if field in _MEGAPASCAL else (values.astype(float), field)


def draw_body(body: Any, title: str, ax: Any) -> Any:
    """A body before any load: blocks by material, mapped fractures dark, bonds thin."""
    from matplotlib.collections import LineCollection, PolyCollection

    ax = axes(ax)
    polygons = np.split(body["corners"], body["ends"][:-1])
    colours = np.array(["#e8dcc4", "#c9d6df", "#d8cfe0", "#cfe0cf"])[np.asarray(body["material"]) % 4]
    ax.add_collection(PolyCollection(polygons, facecolors=colours, edgecolors="#00000055", linewidths=0.4))
    ax.add_collection(LineCollection(body["lines"][body["mapped_fracture"] >= 0], colors=_FRACTURE, linewidths=1.6))
    _finish_map(ax)
    ax.set_title(title)
    return ax


def _finish_map(ax: Any) -> None:
    ax.set_aspect("equal")
    ax.autoscale_view()
    ax.set(xlabel="x (m)", ylabel="y (m)")
