"""Kluft in Python: how fractured rock deforms, slips and breaks.

    import kluft

    results = kluft.open("results/quickstart")     # what a run has left
    results.plot()

    scene = kluft.Scene.from_yaml("models/quickstart.yaml")
    scene["materials.sandstone.cohesion"] = "8 MPa"
    print(scene.run("results/harder").summary["peak_stress"])

    for row in kluft.Simulation(scene):             # load step by load step
        print(row["axial_strain"], row["axial_stress"])

All numbers are in SI units; stresses and strains are positive in compression. docs/python.md has more.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .errors import InputError, NoEquilibriumError, Problem, ResourceError
from .fields import Fields
from .program import validate
from .results import Results
from .results import open_results as open
from .sweep import Sweep
from .tables import frame, read_table

if TYPE_CHECKING:
    from .scene import Check, Scene
    from .simulation import INTERFACE_STATUS, Simulation

    __version__: str

__all__ = ["Check", "Fields", "INTERFACE_STATUS", "InputError", "NoEquilibriumError", "Problem", "ResourceError", "Results", "Scene", "Simulation", "Sweep",
           "frame", "open", "read_table", "validate"]

#: What needs the library; reading results needs NumPy only.
_OF_LIBRARY = {"Scene": "scene", "Check": "scene", "Simulation": "simulation", "INTERFACE_STATUS": "simulation"}


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name == "__version__":
        return import_module("._core", __name__).version
    if name not in _OF_LIBRARY:
        raise AttributeError(f"module 'kluft' has no attribute '{name}'")
    try:
        return getattr(import_module(f".{_OF_LIBRARY[name]}", __name__), name)
    except ImportError as error:
        if "_core" not in str(error):
            raise
        raise ImportError(f"kluft.{name} needs Kluft's compiled module, which is not here ({error}); scripts/build makes it, and so does "
                          "`pip install .` or Debian's package python3-kluft") from None


def __dir__() -> list[str]:
    return sorted([*globals(), *_OF_LIBRARY, "__version__"])
