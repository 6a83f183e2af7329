"""A run whose load steps are taken one at a time."""

from __future__ import annotations

import functools
import sys
import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Callable

import numpy as np

from . import _core
from .errors import NoEquilibriumError, ResourceError
from .fields import Fields
from .progress import ProgressLine
from .scene import Scene
from .tables import Frames, table_of

#: Meaning of the numbers in `Simulation.interface_status`.
INTERFACE_STATUS = ("potential_crack", "fracture", "tension_crack", "shear_crack")


class Simulation:
    """A run of a scene, step by step:

        for row in kluft.Simulation(scene):
            print(row["axial_strain"], row["axial_stress"])

    Each pass is one load step, `row` its row of `history`. Between two steps the state can be looked at. With `output` it writes
    what `kluft run` writes, row by row; without, nothing. The interpreter is free while a load step is computed. One
    simulation computes at a time in a process.

    Ctrl-C takes effect after the load step in progress: KeyboardInterrupt is thrown, the state is saved (with `output`), and
    the same simulation can be gone on with. A second one takes effect between two solves and drops the load step.
    """

    def __init__(self, scene: Scene | Mapping[str, Any], output: str | Path | None = None, *, resume: bool = False,
                 force: bool = False, threads: int = 0) -> None:
        """`resume` goes on from the state saved in `output`; `force` replaces results of another scene there. `threads`: of the factorization, of bodies with 20 000 unknowns or
        more; 0: as many as the BLAS takes. Throws InputError, ResourceError."""
        self.scene = scene if isinstance(scene, Scene) else Scene(scene)
        self.output = Path(output) if output is not None else None
        if resume and self.output is None:
            raise ValueError("resume: expected an output to go on from")
        _warn_of_slow_kernels()
        self._rows: list[str] = []
        directory = str(self.output) if self.output is not None else ""
        self._run: _core.Simulation = self.scene._call(lambda text: _core.Simulation(text, directory, resume, force, threads))

    # ---- going on ----------------------------------------------------------------------------------------------------

    def __iter__(self) -> Iterator[np.void]:
        return self

    def __next__(self) -> np.void:
        """Takes a load step; its row. Ends with StopIteration; throws NoEquilibriumError, ResourceError."""
        return self._next(None)

    def _next(self, show: Callable[[str], None] | None) -> np.void:
        row = self._run.advance(show)
        if row is not None and not self._rows and self._run.step == 0:
            self._rows.append(row)  # the state before any load
            row = self._run.advance(show)
        if row is None:
            self._raise_failure()
            raise StopIteration
        self._rows.append(row)
        return table_of(f"{self._run.header}\n{row}\n")[0]

    def _raise_failure(self) -> None:
        if self.status in ("no_equilibrium", "unbalanced"):
            raise NoEquilibriumError(self._run.diagnosis, self.output)
        if self.status == "out_of_resources":
            raise ResourceError(self._run.diagnosis, self.output)

    def run(self, *, progress: bool = False, on_step: Callable[[np.void], Any] | None = None, may_fail: bool = False) -> Simulation:
        """Goes on to the end. `on_step` is called with the row of each load step; `progress` shows where the run stands."""
        line = ProgressLine() if progress else None
        try:
            while True:
                row = self._next(line.show if line else None)
                if on_step is not None:
                    on_step(row)
        except StopIteration:
            pass
        except NoEquilibriumError:
            if not may_fail:
                raise
        finally:
            if line:
                line.clear()
        if progress and self._run.closing:
            print(self._run.closing, file=sys.stderr)
        return self

    def save(self) -> None:
        """Saves the state in `output`, with all rows that belong to it. Without an output nothing is done."""
        self._run.save()

    def close(self) -> None:
        """Ends the run where it stands; with `output`, state, summary and pictures are written. Nothing more can be computed."""
        self._run.close()

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # ---- where it stands ---------------------------------------------------------------------------------------------

    @property
    def status(self) -> str:
        """"running", or how the run has ended: "done", "collapsed", "no_equilibrium", "unbalanced", "out_of_resources",
        "interrupted"."""
        return self._run.status

    @property
    def warnings(self) -> list[str]:
        """Of the scene and its body; at the end of the run also its own."""
        return self._run.warnings

    @property
    def step(self) -> int:
        """Load steps so far."""
        return self._run.step

    @property
    def stage(self) -> int:
        """The stage in progress, from 0."""
        return self._run.stage

    @property
    def load_factor(self) -> float:
        """Of the stage, 0 to 1."""
        return self._run.load_factor

    @property
    def n_blocks(self) -> int:
        return self._run.n_blocks

    @property
    def history(self) -> np.ndarray:
        """The rows so far, a structured array with the columns of history.csv; row 0 is the state before any load. A resumed
        simulation has the rows since then."""
        return table_of("\n".join([self._run.header, *self._rows, ""]))

    @property
    def frames(self) -> Frames:
        """`frames.history` is the history as a pandas DataFrame."""
        return Frames(self)

    @property
    def unknowns(self) -> np.ndarray:
        """The state: (n_blocks, 6) lengths in m, (u_x, u_y, D11, D21, D12, D22) per block. A point X of a block with centroid X_c
        and size h = sqrt(area) is at X + u + D (X - X_c)/h.

        A view without copy, read-only, of the state after this load step: the simulation copies a state once when it is first
        asked for, because the next step moves on in other memory. The view stays what it is.
        """
        return self._run.unknowns

    @property
    def displacement(self) -> np.ndarray:
        """Displacement of each block's centroid, (n_blocks, 2) in m: the first two columns of `unknowns`, without copy."""
        return self.unknowns[:, :2]

    @property
    def interface_status(self) -> np.ndarray:
        """What has become of each interface, (n_interfaces,) uint8, a view as `unknowns` is: 0 potential crack (bonded), 1 mapped
        fracture, 2 cracked in tension, 3 cracked in shear (`INTERFACE_STATUS`)."""
        return self._run.interface_status

    def fields(self) -> Fields:
        """Stresses, displacements, interfaces and tractions of the state, computed for this call."""
        blocks, interfaces = self._run.fields()
        return Fields(self.step, blocks, interfaces)

    def __repr__(self) -> str:
        return f"<kluft.Simulation of {self.scene.name}: {self.status}, {self.n_blocks} blocks>"


@functools.cache
def _warn_of_slow_kernels() -> None:
    """Once. The program starts itself again with other kernels where the BLAS does not know the processor; a module cannot, and NumPy
    has loaded the BLAS before it."""
    better = _core.wider_blas_core()
    if better:
        warnings.warn(f"the BLAS takes kernels for {_core.blas_core()} on this processor, which are up to 4 times slower than those for "
                      f"{better}, which the program takes, and give other last digits; start Python with OPENBLAS_CORETYPE={better}",
                      stacklevel=3)
