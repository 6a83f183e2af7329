"""What a run left in its directory."""

from __future__ import annotations

import base64
import html
import json
import warnings
from functools import cached_property
from pathlib import Path
from typing import Any, Iterable

import numpy as np

from .errors import InputError
from .fields import Fields
from .tables import Frames, read_table

_HEADLINE = (
    ("status", "status", "", 1.0),
    ("peak_stress", "peak axial stress", "MPa", 1e-6),
    ("peak_strain", "axial strain there", "%", 100.0),
    ("residual_stress", "residual axial stress", "MPa", 1e-6),
    ("factor_of_safety", "factor of safety", "", 1.0),
    ("youngs_modulus", "Young's modulus", "GPa", 1e-9),
    ("poissons_ratio", "Poisson's ratio", "", 1.0),
    ("cracks_tension", "cracks by tension", "", 1.0),
    ("cracks_shear", "cracks by shear", "", 1.0),
    ("steps", "load steps", "", 1.0),
    ("unbalanced_steps", "of which unbalanced", "", 1.0),
    ("blocks", "blocks", "", 1.0),
    ("elapsed_s", "time", "s", 1.0),
)


def open_results(directory: str | Path) -> Any:
    """Opens what a run has left in a directory (`kluft run SCENE -o DIR`, `Scene.run`): a `Results`. The directory of a study is
    a `Sweep`. Of a run that is still going on it has what is there so far; open it again to see more.

    Throws InputError where there are no results.
    """
    directory = Path(directory)
    if (directory / "study.csv").exists():
        from .sweep import Sweep

        return Sweep(directory)
    if not (directory / "history.csv").exists():
        raise InputError(_no_results(directory))
    return Results(directory)


def _no_results(directory: Path) -> str:
    from difflib import get_close_matches

    place = f"{directory}: expected a directory of results"
    if directory.is_file():
        return f"{place}, found a file"
    if not directory.exists():
        parent = directory.parent
        names = [path.name for path in parent.iterdir() if path.is_dir()] if parent.is_dir() else []
        near = get_close_matches(directory.name, names, 1)
        return f"{place}, found nothing" + (f"; did you mean '{parent / near[0]}'?" if near else "")
    return f"{place}, found no history.csv in it"


class Results:
    """The results of a run. Tables are NumPy structured arrays, one field per column of the CSV file of the same name, read when
    first asked for; `frames` has them as pandas DataFrames. SI units; stresses and strains are positive in compression."""

    def __init__(self, directory: str | Path) -> None:
        self.directory = Path(directory)

    def __repr__(self) -> str:
        return f"<kluft.Results of {self.directory}: {self.status}, {len(self.history)} rows>"

    @cached_property
    def summary(self) -> dict[str, Any]:
        """summary.json; empty while the run goes on, or where it was killed."""
        path = self.directory / "summary.json"
        return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}

    @property
    def status(self) -> str:
        """"done", "collapsed", "no_equilibrium", "unbalanced", "out_of_resources", "interrupted"; "unfinished" of a run that
        goes on or was killed."""
        return self.summary.get("status", "unfinished")

    @property
    def title(self) -> str:
        return self.summary.get("title") or self.directory.absolute().name

    @cached_property
    def history(self) -> np.ndarray:
        """One row per load step, row 0 the initial state: step, stage, load_factor, axial_strain, axial_stress (Pa), ..."""
        return self._table("history")

    @cached_property
    def equilibria(self) -> np.ndarray:
        """The same columns for every equilibrium, also those just before bonds fail."""
        return self._table("equilibria")

    @cached_property
    def cracks(self) -> np.ndarray:
        """One row per broken interface: step, pass, interface, x, y (m), mode ("tension" or "shear"), p1, p3 (Pa), axial_strain."""
        return self._table("cracks")

    @cached_property
    def jumps(self) -> np.ndarray:
        """Where equilibrium was lost at fixed loads: step, load_factor, released_energy (J/m), largest_slip (m), blocks."""
        return self._table("jumps")

    @cached_property
    def histories(self) -> np.ndarray:
        """step, stage, load_factor and what the scene follows (`output.histories`)."""
        return self._table("histories")

    @property
    def frames(self) -> Frames:
        """The tables as pandas DataFrames: `results.frames.history`, `.equilibria`, `.cracks`, `.jumps`, `.histories`."""
        return Frames(self)

    def _table(self, name: str) -> np.ndarray:
        path = self.directory / f"{name}.csv"
        if not path.exists():
            raise InputError(f"{path}: expected a table of the run, found none")
        return read_table(path)

    @property
    def steps(self) -> list[int]:
        """The load steps whose fields were kept (`output.fields_every`), ascending."""
        files = (self.directory / "fields").glob("interfaces_*.vtu")
        return sorted(int(path.stem.split("_")[1]) for path in files)

    def fields(self, step: int | str = "last") -> Fields:
        """The fields of a load step that was kept: its number, "last", or "peak" for that with the largest axial stress at its end
        (the nearest one, with a warning, where that was not kept). Throws InputError where none is kept, or not this one."""
        steps = self.steps
        if not steps:
            raise InputError(f"{self.directory}: expected fields of load steps, found none (output.fields is false?)")
        if step == "last":
            return Fields.of_run(self.directory, steps[-1])
        if step == "peak":
            peak = self._step_of_peak()
            nearest = min(steps, key=lambda each: abs(each - peak))
            if nearest != peak:
                warnings.warn(f"the fields of load step {peak}, where the peak is, were not kept; these are of step {nearest} "
                              "(output.fields_every: 1 keeps all)", stacklevel=2)
            return Fields.of_run(self.directory, nearest)
        if step not in steps:
            words = [str(kept) for kept in steps]
            kept = ", ".join(words if len(words) < 20 else [*words[:10], "...", *words[-5:]])
            raise InputError(f'{self.directory}: expected "last", "peak" or one of the load steps {kept}, found {step!r}')
        return Fields.of_run(self.directory, int(step))

    def _step_of_peak(self) -> int:
        """The load step with the largest axial stress at its end."""
        rows = self.history[self.history["balanced"].astype(bool)]
        rows = rows[rows["stage"] >= (self.summary.get("platen_stage") or 0)]
        if len(rows) == 0 or not self.moves_platen:
            raise InputError(f"{self.directory}: expected a run with a peak of the axial stress, found none")
        whole = rows[~(rows["net_broken"] >= 0.7)]  # a net 70 % of whose bonds have failed may have locked
        rows = whole if len(whole) > 0 else rows[:1]
        return int(rows["step"][np.argmax(self._sense * rows["axial_stress"])])

    @property
    def peak(self) -> np.void:
        """The row of `equilibria` with the peak of the axial stress. Throws InputError where there is none."""
        balanced = self.equilibria[self.equilibria["balanced"]]
        balanced = balanced[balanced["stage"] >= (self.summary.get("platen_stage") or 0)]
        stress = self.summary.get("peak_stress")
        if len(balanced) == 0 or not self.moves_platen:
            raise InputError(f"{self.directory}: expected a run with a peak of the axial stress, found none")
        if stress is None:
            return balanced[np.argmax(self._sense * balanced["axial_stress"])]
        return balanced[np.argmin(np.abs(balanced["axial_stress"] - stress))]

    @property
    def moves_platen(self) -> bool:
        """Whether there is a curve of stress over strain."""
        if "platen_stage" in self.summary:
            return self.summary["platen_stage"] is not None
        return bool(np.any(self.history["axial_strain"] != 0.0))

    @property
    def _sense(self) -> float:
        """-1 where the platen pulls: stresses and strains of a strength are negative then."""
        strains = self.history["axial_strain"]
        moved = strains[(strains != 0.0) & (self.history["stage"] >= (self.summary.get("platen_stage") or 0))]
        return -1.0 if len(moved) > 0 and moved[-1] < 0.0 else 1.0

    def plot(self, *, ax: Any = None, label: str | None = None) -> Any:
        """Differential stress over axial strain with the peak; of a run without a platen its blocks. Returns the Axes."""
        from .plots import draw_curve

        return draw_curve(self, ax, label) if self.moves_platen else self.fields().plot(ax=ax)

    def animate(self, path: str | Path, *, field: str = "sigma_1", scale: float = 1.0, fps: float = 4.0) -> Path:
        """Writes the kept states (`output.fields_every: 1` keeps all) one after the other as a film: .gif, or with the program
        ffmpeg .mp4. Blocks are coloured by `field` as in `Fields.plot`, with displacements times `scale`; `fps` states each second.
        Returns the path. Throws InputError where no state is kept."""
        from .plots import animate

        states = [self.fields(step) for step in self.steps] or [self.fields()]
        animate(states, Path(path), field, scale, fps)
        return Path(path)

    def headline(self) -> Iterable[tuple[str, str]]:
        """What is worth a look in the summary, as (name, value with unit)."""
        for key, name, unit, factor in _HEADLINE:
            value = self.summary.get(key)
            if value is None:
                continue
            number = not isinstance(value, (str, bool))
            yield name, f"{factor * value:.4g} {unit}".strip() if number else str(value)

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><td>{html.escape(name)}</td><td>{html.escape(value)}</td></tr>" for name, value in self.headline())
        rows += "".join(f'<tr><td colspan="2">{html.escape(text)}</td></tr>' for text in self.summary.get("warnings") or [])
        title = f"<b>{html.escape(self.title)}</b> <code>{html.escape(str(self.directory))}</code>"
        return f"{title}<table>{rows or '<tr><td>unfinished</td></tr>'}</table>{self._picture()}"

    def _picture(self) -> str:
        path = self.directory / "curve.png"
        if not path.exists():
            return ""
        return f'<img style="max-width: 30em" src="data:image/png;base64,{base64.b64encode(path.read_bytes()).decode()}">'
