"""Scenes: what a run is made from."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Iterator, Mapping, MutableMapping, Sequence
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable

import numpy as np

from . import _core
from .errors import InputError, together
from .tables import Frames

if TYPE_CHECKING:
    from .results import Results
    from .sweep import Sweep


class Check:
    """What a scene amounts to, without running it: what `kluft check` says."""

    def __init__(self, account: dict[str, Any]) -> None:
        self.blocks: int = account["blocks"]
        self.interfaces: int = account["interfaces"]
        self.unknowns: int = account["unknowns"]
        self.smallest_area: float = account["smallest_area"]  #: m2
        self.smallest_edge: float = account["smallest_edge"]  #: m
        self.smallest_angle: float = account["smallest_angle"]  #: between successive edges of a block, radians
        self.merged: int = account["merged"]  #: slivers that went into a neighbour
        self.memory_bytes: float = account["memory_bytes"]  #: largest memory of a run, about
        self.warnings: list[str] = account["warnings"]
        #: All of it in words, a structured array with the fields "name" and "text".
        self.table: np.ndarray = np.array(account["lines"], dtype=[("name", "U16"), ("text", "U200")])
        self._text: str = account["text"]

    @property
    def frames(self) -> Frames:
        """`frames.table` is the table as a pandas DataFrame."""
        return Frames(self)

    def __str__(self) -> str:
        return self._text

    __repr__ = __str__

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><td>{html.escape(name)}</td><td style='text-align: left'>{html.escape(text)}</td></tr>"
                       for name, text in [*self.table, *(("warning", warning) for warning in self.warnings)])
        return f"<table>{rows}</table>"


class Scene(MutableMapping[str, Any]):
    """A scene (docs/scene.md), checked by the program's own reader.

    Keys are paths as in `--set`: `scene["materials.rock.cohesion"] = "8 MPa"`; lists are indexed from 0, the number of items
    appends one. Values are numbers in SI (angles in degrees), texts with a unit, lists, mappings, arrays; a mapping replaces another one
    as a whole. A key that does not exist
    or a value that it does not take throws `InputError` at once and changes nothing; how keys go together is checked by `check`
    and by every run.
    """

    def __init__(self, content: Mapping[str, Any] | None = None, *, name: str = "scene") -> None:
        """From a mapping with the keys of a scene file. `name` is what results are called after; relative names of files in it
        start from the working directory."""
        self._text = _yaml({"kluft": 1} if content is None else content)
        self._file = str(Path.cwd() / f"{name}.yaml")
        self._from_file = False
        self._settings: list[str] = []
        if content is not None:
            self._refuse(lambda problem: True)

    @classmethod
    def from_yaml(cls, path: str | Path) -> Scene:
        """From a scene file. Throws InputError with path, file, line and hint for what is wrong in it."""
        path = Path(path)
        if not path.exists():
            raise InputError(_no_file(path), file=str(path))
        try:
            text = _core.scene_bytes(str(path)).decode()
        except InputError as error:
            raise InputError(str(error), file=str(path)) from None
        return cls.from_text(text, path)

    @classmethod
    def from_text(cls, text: str, path: str | Path = "scene.yaml") -> Scene:
        """From the text of a scene file. `path` gives the scene's name, its place in messages and where relative names of files
        in it start."""
        scene = cls.__new__(cls)
        scene._text, scene._file, scene._from_file, scene._settings = text, str(path), True, []
        scene._refuse(lambda problem: True)
        return scene

    def copy(self) -> Scene:
        """Another scene that says the same."""
        other = type(self).__new__(type(self))
        other.__dict__ = {**self.__dict__, "_settings": list(self._settings)}
        return other

    @property
    def name(self) -> str:
        """What results are called after: the stem of the file."""
        return Path(self._file).stem

    # ---- a mapping ---------------------------------------------------------------------------------------------------

    def __getitem__(self, key: str) -> Any:
        _require_text(key)
        value: Any = self.to_dict()
        for place, word in enumerate(key.split(".")):
            try:
                value = value[_index(word)] if isinstance(value, list) else value[word]
            except (KeyError, IndexError, TypeError, ValueError):
                near = get_close_matches(word, value, 1) if isinstance(value, dict) else []
                hint = f"; did you mean '{'.'.join([*key.split('.')[:place], *near])}'?" if near else ""
                raise KeyError(f"the scene does not say {key}{hint}") from None
        return value

    def __setitem__(self, key: str, value: Any) -> None:
        _require_key(key)
        parent, _, word = key.rpartition(".")
        if isinstance(value, Mapping) and isinstance(self.get(key), dict):  # which --set would merge
            if isinstance(self.get(parent), list):
                items = self[parent]
                items[int(word)] = value
                self[parent] = items
                return
            self._set(key, [f"{key}=null", f"{key}={_yaml(value)}"])
            return
        self._set(key, [f"{key}={_yaml(value)}"])

    def _set(self, key: str, settings: list[str]) -> None:
        before = self._settings
        self._settings = [*before, *settings]
        missed = key if settings == [f"{key}=null"] else None  # only the whole scene misses what is taken away
        try:
            self._refuse(lambda problem: not problem.file and _is_about(problem.path, key) and problem.path != missed)
        except InputError:
            self._settings = before
            raise

    def __delitem__(self, key: str) -> None:
        self[key]
        self._settings = [*self._settings, f"{key}=null"]

    def __iter__(self) -> Iterator[str]:
        return iter(self.to_dict())

    def __len__(self) -> int:
        return len(self.to_dict())

    def __contains__(self, key: object) -> bool:
        try:
            self[str(key)]
        except KeyError:
            return False
        return True

    def to_dict(self) -> dict[str, Any]:
        """All that the scene says, what it extends and what was set in it; a copy."""
        return self._call(_core.scene_value)

    def to_yaml(self, path: str | Path | None = None) -> str:
        """The same as the text of a scene file, names of files absolute; written to `path` if there is one. Throws InputError for
        a scene that cannot be run."""
        text = self._call(_core.scene_yaml)
        if path is not None:
            Path(path).write_text(text, encoding="utf-8")
        return text

    # ---- fractures ---------------------------------------------------------------------------------------------------

    def add_traces(self, traces: Any, interface: str, *, file: str | Path | None = None) -> None:
        """Adds mapped fractures: a list of arrays (m, 2) of points in m, or a GeoDataFrame or GeoSeries of lines in a projected
        system of coordinates in m. `interface` is their kind. Many of them (a scene has at most 1 MB) go into the GeoJSON
        `file`, which is written and named in the scene."""
        lines = _lines_of(traces)
        if file is not None:
            features = [{"type": "Feature", "properties": {}, "geometry": {"type": "LineString", "coordinates": line}} for line in lines]
            Path(file).write_text(json.dumps({"type": "FeatureCollection", "features": features}), encoding="utf-8")
            new: list[dict[str, Any]] = [{"file": str(Path(file).absolute()), "file_crs": "local", "interface": interface}]
        else:
            new = [{"trace": line, "interface": interface} for line in lines]
        self["geometry.fractures"] = [*self.get("geometry.fractures", []), *new]

    # ---- at work -----------------------------------------------------------------------------------------------------

    def check(self) -> Check:
        """What the scene amounts to: blocks, unknowns, stiffnesses, memory, warnings. Throws InputError with all that is wrong."""
        return Check(self._call(_core.account))

    def draw(self, *, ax: Any = None) -> Any:
        """Draws the body before any load: blocks by material, mapped fractures dark. Returns the Axes."""
        from .plots import draw_body

        return draw_body(self.body(), str(self.get("title", self.name)), ax)

    def body(self) -> dict[str, np.ndarray]:
        """The body cut into n blocks with m interfaces, read-only arrays: "corners" (k, 2) of all blocks one after the other (m),
        "ends" (n,) where each block's end, "material" (n,); "lines" (m, 2, 2) the interfaces' two ends (m), "block_a" and
        "block_b" (m,), "mapped_fracture" (m,): index, -1 on an edge of the net."""
        return self._call(_core.body)

    def run(self, output: str | Path | None = None, *, progress: bool = False, resume: bool = False, force: bool = False,
            may_fail: bool = False, threads: int = 0, on_step: Callable[[np.void], Any] | None = None) -> Results:
        """Runs the scene in this process and returns its `Results`.

        `output`: the directory of the results (default results/<name>), as `kluft run -o` writes it. `progress` shows where the run
        stands. `on_step` is called with the row of each load step. `resume` goes on from the saved state in the directory, `force`
        replaces results of another scene there. `threads`: of the factorization, of bodies with 20 000 unknowns or more.

        Ctrl-C ends the run after the load step in progress (a second one at once), with the state saved, and KeyboardInterrupt is
        thrown. Throws InputError; NoEquilibriumError where no equilibrium was found, unless `may_fail`; ResourceError out of disk
        or memory. What the run has left is in their `results`.
        """
        from .results import Results
        from .simulation import Simulation

        directory = Path(output) if output is not None else Path("results") / self.name
        simulation = Simulation(self, directory, resume=resume, force=force, threads=threads)
        try:
            simulation.run(progress=progress, on_step=on_step, may_fail=may_fail)
        finally:
            simulation.close()
        return Results(directory)

    def sweep(self, vary: Mapping[str, Sequence[Any]], output: str | Path | None = None, *, replicas: int | Mapping[str, Any] = 0,
              jobs: int = 1, quantities: Sequence[str] = ("peak_stress", "peak_strain"), combine: str = "product",
              progress: bool = False, **study: Any) -> Sweep:
        """Runs the scene with all combinations of values, each case in a process of its own, `jobs` at a time, and sets the results
        side by side: what `kluft study` does.

        `vary`: keys of the scene and their values; `combine="together"` takes the first values of all keys, then the second ones.
        `replicas`: copies of each case with a small perturbation, a number or the mapping of docs/studies.md. `quantities`: numbers
        of the summary. Further keys of a study file are taken by name: `time_limit=60`. `output`: directory (default
        results/<name>-sweep); cases that have ended there are not run again. Ctrl-C lets the running cases save their states.
        """
        from .sweep import run_sweep

        content = {"vary": dict(vary), "replicas": replicas, "quantities": list(quantities), "combine": combine, **study}
        directory = Path(output) if output is not None else Path("results") / f"{self.name}-sweep"
        return run_sweep(self, content, directory, jobs, progress)

    def __repr__(self) -> str:
        return f"<kluft.Scene {self.name}: {self.get('title', 'without a title')}>"

    def _repr_html_(self) -> str:
        return f"<b>{html.escape(self.name)}</b><pre>{html.escape(json.dumps(self.to_dict(), indent=1))}</pre>"

    # ---- to the library ----------------------------------------------------------------------------------------------

    def _as_text(self) -> Any:
        return _core.SceneText(self._text, self._settings, self._file)

    def _call(self, function: Callable[[Any], Any]) -> Any:
        try:
            return function(self._as_text())
        except InputError as error:
            raise self._in_own_words(error) from None

    def _in_own_words(self, error: InputError) -> InputError:
        """What a program has said stands in no file."""
        if self._from_file:
            return error
        own = [problem._replace(file="", line=None, column=None, message=_without_place(problem.message, problem.file))
               if problem.file == self._file else problem for problem in error.problems]
        return together(own)

    def _refuse(self, concerned: Callable[[Any], bool]) -> None:
        """Throws what is wrong with the keys, as far as it is of interest now."""
        try:
            self._call(_core.check_keys)
        except InputError as error:
            problems = [problem for problem in error.problems if concerned(problem)]
            if problems:
                raise together(problems) from None


def _require_text(key: object) -> None:
    if not isinstance(key, str):
        raise TypeError(f"a key of a scene is a text, as in 'stages.1.steps', not {type(key).__name__}")


def _index(word: str) -> int:
    """Of an item of a list, counted from 0. Throws ValueError for anything else."""
    if not word.isdecimal():
        raise ValueError(word)
    return int(word)


def _require_key(key: str) -> None:
    _require_text(key)
    if "=" in key:
        raise InputError(f"{key}: expected a key, found one with '='", path=key)


def _is_about(path: str, key: str) -> bool:
    return not path or path == key or path.startswith(f"{key}.") or key.startswith(f"{path}.")


def _without_place(message: str, file: str) -> str:
    """"scene.yaml:1:20: key: what" and the line below as "key: what"."""
    return re.sub(re.escape(file) + r":\d+:\d+: ", "", message).split("\n")[0]


_PLAIN = re.compile(r"[-+]?[0-9][0-9.eE+-]* ?[A-Za-z%°‰][A-Za-z0-9/%^ ]*|[A-Za-z][A-Za-z0-9_-]*")
_WORDS = frozenset(["null", "true", "false", "yes", "no", "on", "off"])  # that YAML may take for something else


def _is_plain(text: str) -> bool:
    try:
        float(text)  # a number in quotes is none
        return False
    except ValueError:
        return bool(_PLAIN.fullmatch(text)) and text.lower() not in _WORDS and text == text.strip()


def _yaml(value: Any) -> str:
    """A value on one line of YAML; arrays as lists. Quantities and names have no quotes, as people write them."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{json.dumps(str(key), ensure_ascii=False)}: {_yaml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, (np.ndarray, np.generic)):
        return _yaml(value.tolist())
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_yaml, value)) + "]"
    if isinstance(value, Path):
        return _yaml(str(value))
    if isinstance(value, str) and _is_plain(value):
        return value
    if value is None or isinstance(value, (str, bool, int, float)):
        return json.dumps(value, ensure_ascii=False)
    raise InputError(f"expected numbers, texts, lists and mappings in a scene, found {type(value).__name__}")


def _lines_of(traces: Any) -> list[list[list[float]]]:
    geometry = getattr(traces, "geometry", None)
    if geometry is not None:
        parts = [part for shape in geometry for part in getattr(shape, "geoms", [shape])]
        traces = [np.asarray(part.coords)[:, :2] for part in parts]
    lines = [np.asarray(trace, dtype=float) for trace in traces]
    for number, line in enumerate(lines):
        if line.ndim != 2 or line.shape[1] != 2 or len(line) < 2:
            raise InputError(f"trace {number}: expected an array of at least 2 points (m, 2), found one of shape {line.shape}")
    return [line.tolist() for line in lines]


def _no_file(path: Path) -> str:
    names = [each.name for each in path.parent.iterdir()] if path.parent.is_dir() else []
    near = get_close_matches(path.name, names, 1)
    hint = f"; did you mean '{path.parent / near[0]}'?" if near else ""
    return f"{path}: expected a scene, found no such file{hint}"
