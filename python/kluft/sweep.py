"""Sweeps: a scene with many settings side by side."""

from __future__ import annotations

import html
import warnings
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError, ResourceError
from .progress import ProgressLine
from .tables import Frames, read_table

if TYPE_CHECKING:
    from .results import Results
    from .scene import Scene


class Sweep:
    """What a sweep, or `kluft study`, has left in its directory."""

    def __init__(self, directory: str | Path) -> None:
        self.directory = Path(directory)

    @cached_property
    def table(self) -> np.ndarray:
        """One row per case, a structured array: case, one field per varied key, replica, status, the quantities (SI), their errors
        against the reference, cpu_s, elapsed_s, reason."""
        return read_table(self.directory / "study.csv")

    @property
    def frames(self) -> Frames:
        """`frames.table` is the table as a pandas DataFrame."""
        return Frames(self)

    @property
    def report(self) -> Path:
        """The report with plots and a recommendation."""
        return self.directory / "study.html"

    def __len__(self) -> int:
        return len(self.table)

    def __getitem__(self, case: int | str) -> Results:
        """The results of a case, by its row or its name. Throws InputError for one without results."""
        from .results import open_results

        name = str(self.table["case"][case]) if isinstance(case, (int, np.integer)) else case
        return open_results(self.directory / "cases" / name)

    def __repr__(self) -> str:
        return f"<kluft.Sweep of {len(self)} cases in {self.directory}>"

    def _repr_html_(self) -> str:
        names = [name for name in self.table.dtype.names or () if name not in ("cpu_s", "reason", "variant")]
        head = "".join(f"<th>{html.escape(name)}</th>" for name in names)
        rows = "".join("<tr>" + "".join(f"<td>{_cell(row[name])}</td>" for name in names) + "</tr>" for row in self.table)
        return f"<table><tr>{head}</tr>{rows}</table>"


def _cell(value: Any) -> str:
    return f"{value:.5g}" if isinstance(value, np.floating) else html.escape(str(value))


_MARK = "# Written by Scene.sweep in Python.\n"


def _write_own(path: Path, text: str) -> None:
    """Replaces a file that an earlier sweep has written, never another one."""
    if path.exists() and not path.read_text(encoding="utf-8", errors="replace").startswith(_MARK):
        raise InputError(f"{path}: expected a file of an earlier sweep or none, found another one, which would be lost; choose another "
                         "output")
    path.write_text(_MARK + text, encoding="utf-8")


def run_sweep(scene: Scene, content: dict[str, Any], directory: Path, jobs: int, progress: bool) -> Sweep:
    """Writes the scene and the study into the directory and runs what has not ended there."""
    from . import _core
    from .program import program
    from .scene import _yaml

    if jobs < 1:
        raise InputError(f"jobs: expected a number >= 1, found {jobs}")
    if directory.is_file():
        raise InputError(f"{directory}: expected a directory for the results, found a file")
    directory = directory.absolute()
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ResourceError(f"{directory}: cannot make the directory: {error.strerror}") from None
    base = directory / f"{scene.name}.yaml"
    _write_own(base, scene.to_yaml())
    replicas = content.pop("replicas")
    if replicas:
        content["replicas"] = replicas
    text = _yaml({"title": str(scene.get("title", scene.name)), "scene": str(base), **content})
    study = directory / "study.yaml"
    _write_own(study, text + "\n")
    line = ProgressLine() if progress else None
    try:
        _core.run_study(text, str(study), str(directory), str(program()), jobs, line.show if line else None)
    finally:
        if line:
            line.clear()
    sweep = Sweep(directory)
    _warn_of_failed(sweep)
    return sweep


def _warn_of_failed(sweep: Sweep) -> None:
    """Cases that found no equilibrium have numbers of what they came to before; nobody should take them for those of a whole run."""
    failed = [f"{row['case']} ({row['status']})" for row in sweep.table if row["status"] != "done"]
    if failed:
        named = ", ".join(failed[:5]) + (f" and {len(failed) - 5} more" if len(failed) > 5 else "")
        warnings.warn(f"{len(failed)} of {len(sweep)} cases did not end as done: {named}; see `status` and `reason` in the table",
                      stacklevel=3)
