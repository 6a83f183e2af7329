"""Fields of one load step: blocks with displacements and stresses, interfaces and contacts with tractions and slip."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from .errors import InputError, missing
from .tables import Frames, read_table
from .vtu import data_arrays

_STATES = np.array(["open", "sliding", "locked"])
_CRACKS = np.array(["", "tension", "shear"])


class Fields:
    """The body at the end of a load step. SI units; coordinates are those of the scene; stresses and normal tractions are
    positive in compression."""

    def __init__(self, step: int, blocks: Path | bytes, interfaces: Path | bytes, directory: Path | None = None) -> None:
        """From two field files, or their contents, and the directory of the run that has tables beside them."""
        self.step = step  #: load step, through all stages
        self._directory = directory
        self._sources = {"blocks": blocks, "interfaces": interfaces}
        sections = data_arrays(blocks)
        self._corners = sections["Points"]["Points"][:, :2]
        self._moves = sections["PointData"]["displacement"][:, :2]
        self._shape = sections["Cells"]["connectivity"]
        self._ends = sections["Cells"]["offsets"]
        cells = sections["CellData"]
        #: Cauchy stress of each block, (n, 2, 2), Pa, positive in compression.
        self.stress: np.ndarray = np.ascontiguousarray(cells["stress"].reshape(-1, 3, 3)[:, :2, :2])
        #: Principal stresses in the plane, (n,), Pa, positive in compression, sigma_1 >= sigma_3.
        self.sigma_1: np.ndarray = cells["sigma_1"]
        self.sigma_3: np.ndarray = cells["sigma_3"]
        #: Index of each block's material in the order of the scene, (n,).
        self.material: np.ndarray = cells["material"]

    @classmethod
    def of_run(cls, directory: Path, step: int) -> Fields:
        """Of a step that was kept in a directory of results."""
        blocks, interfaces = (directory / "fields" / f"{part}_{step:06}.vtu" for part in ("blocks", "interfaces"))
        return cls(step, blocks, interfaces, directory)

    def _table(self, kind: str) -> Path | None:
        """The table of this step in a folder of tables that are named by their steps."""
        if self._directory is None:
            return None
        files = [path for path in (self._directory / kind).glob("*.csv") if path.stem.isdigit() and int(path.stem) == self.step]
        return files[0] if files else None

    def __len__(self) -> int:
        """Number of blocks n."""
        return len(self._ends)

    def __repr__(self) -> str:
        return f"<kluft.Fields of load step {self.step}: {len(self)} blocks>"

    @cached_property
    def polygons(self) -> list[np.ndarray]:
        """Corners of each block before loading, a list of n arrays (m, 2) in m, counter-clockwise."""
        return self._per_block(self._corners)

    @cached_property
    def displacements(self) -> list[np.ndarray]:
        """Displacement of the same corners, a list of n arrays (m, 2) in m."""
        return self._per_block(self._moves)

    def deformed(self, scale: float = 1.0) -> list[np.ndarray]:
        """Corners of each block where they are now, displacements times `scale`; a list of n arrays (m, 2) in m."""
        return self._per_block(self._corners + scale * self._moves)

    @cached_property
    def centroids(self) -> np.ndarray:
        """Centroid of each block before loading, (n, 2) in m."""
        return self._at_centroids(self._corners)

    @cached_property
    def displacement(self) -> np.ndarray:
        """Displacement of each block's centroid, (n, 2) in m."""
        return self._at_centroids(self._moves)

    @cached_property
    def areas(self) -> np.ndarray:
        """Area of each block before loading, (n,) in m2."""
        return np.array([0.5 * np.sum(_cross(p, np.roll(p, -1, axis=0))) for p in self._local(self._corners)])

    @cached_property
    def interfaces(self) -> np.ndarray:
        """Where two blocks met before loading, a structured array with one row per interface:

        interface, block_a, block_b; x, y: its middle before loading (m); length (m); normal_x, normal_y: from a to b;
        state: "open", "sliding" or "locked"; bonded; crack: "tension", "shear" or ""; mapped_fracture: index, -1 on an
        edge of the net; normal_traction (Pa, positive in compression), shear_traction (Pa), gap (m, positive when open),
        slip (m).
        """
        sections = data_arrays(self._sources["interfaces"])
        cells = sections["CellData"]
        ends = sections["Points"]["Points"][:, :2].reshape(-1, 2, 2)
        along = ends[:, 1] - ends[:, 0]
        length = np.hypot(along[:, 0], along[:, 1])
        middle = ends.mean(axis=1)
        unknown = np.full(len(length), -1, dtype=np.int32)  # in files of a version that did not name the blocks
        columns = {
            "interface": cells["interface"], "block_a": cells.get("block_a", unknown), "block_b": cells.get("block_b", unknown),
            "x": middle[:, 0], "y": middle[:, 1], "length": length,
            "normal_x": along[:, 1] / length, "normal_y": -along[:, 0] / length,
            "state": _STATES[cells["state"]], "bonded": cells["bonded"] == 1, "crack": _CRACKS[cells["crack_mode"]],
            "mapped_fracture": cells["mapped_fracture"],
            "normal_traction": cells["normal_traction"], "shear_traction": cells["shear_traction"],
            "gap": cells["gap"], "slip": cells["slip"],
        }
        table = np.empty(len(length), dtype=[(name, column.dtype) for name, column in columns.items()])
        for name, column in columns.items():
            table[name] = column
        return table

    def interface_lines(self, scale: float = 1.0) -> np.ndarray:
        """Ends of the interfaces, (n, 2, 2) in m: [interface, end, coordinate], displaced by `scale` times the mean of both sides."""
        sections = data_arrays(self._sources["interfaces"])
        ends = sections["Points"]["Points"][:, :2] + scale * sections["PointData"]["displacement"][:, :2]
        return ends.reshape(-1, 2, 2)

    @cached_property
    def contacts(self) -> np.ndarray:
        """What touches, a structured array with one row per contact: at least block_a, block_b, x, y (m), length (m),
        normal_x, normal_y (from a to b), normal_traction (Pa, positive in compression), shear_traction (Pa), state.

        From the file of contacts where the run has written one, else the interfaces that are not open.
        """
        path = self._table("contacts")
        if path is not None:
            return read_table(path)
        return self.interfaces[self.interfaces["state"] != "open"]

    @cached_property
    def supports(self) -> np.ndarray:
        """Forces of the supports on blocks, a structured array: block, boundary, fx, fy (N per m of thickness)."""
        path = self._table("supports")
        if path is None:
            raise InputError(f"{self._directory or 'simulation'}: expected supports/{self.step}.csv, found no forces of supports of this step")
        return read_table(path)

    @property
    def frames(self) -> Frames:
        """`interfaces`, `contacts`, `supports` and `blocks` as pandas DataFrames."""
        return Frames(self)

    @cached_property
    def blocks(self) -> np.ndarray:
        """One row per block, a structured array: block, x, y (centroid before loading, m), area (m2), material, ux, uy (m),
        stress_xx, stress_xy, stress_yy, sigma_1, sigma_3 (Pa, positive in compression)."""
        columns = {
            "block": np.arange(len(self)), "x": self.centroids[:, 0], "y": self.centroids[:, 1], "area": self.areas,
            "material": self.material, "ux": self.displacement[:, 0], "uy": self.displacement[:, 1],
            "stress_xx": self.stress[:, 0, 0], "stress_xy": self.stress[:, 0, 1], "stress_yy": self.stress[:, 1, 1],
            "sigma_1": self.sigma_1, "sigma_3": self.sigma_3,
        }
        table = np.empty(len(self), dtype=[(name, column.dtype) for name, column in columns.items()])
        for name, column in columns.items():
            table[name] = column
        return table

    def plot(self, field: str = "sigma_1", *, scale: float = 1.0, ax: Any = None) -> Any:
        """Draws the blocks, deformed by `scale` times their displacements, with a colour for `field`: a column of `blocks`
        or "displacement" (its size). Cracks by tension are red, by shear blue, fractures dark. Returns the Axes."""
        from .plots import draw_fields

        return draw_fields(self, field, scale, ax)

    def to_vtk(self, part: str = "blocks") -> Any:
        """The "blocks" or the "interfaces" as a vtkUnstructuredGrid."""
        try:
            from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
        except ImportError as error:
            raise missing("vtk9", "to_vtk()") from error
        reader = vtkXMLUnstructuredGridReader()
        source = self._sources[part]
        if isinstance(source, bytes):
            reader.ReadFromInputStringOn()
            reader.SetInputString(source, len(source))
        else:
            reader.SetFileName(str(source))
        reader.Update()
        return reader.GetOutput()

    def to_geopandas(self, *, scale: float = 1.0) -> Any:
        """The blocks, deformed by `scale` times their displacements, as a GeoDataFrame with the columns of `blocks`."""
        try:
            import geopandas
            from shapely.geometry import Polygon
        except ImportError as error:
            raise missing("geopandas", "to_geopandas()") from error
        shapes = [Polygon(polygon) for polygon in self.deformed(scale)]
        shapes = [shape if shape.is_valid else shape.buffer(0) for shape in shapes]
        return geopandas.GeoDataFrame(self.frames.blocks, geometry=shapes)

    def _per_block(self, values: np.ndarray) -> list[np.ndarray]:
        return np.split(values[self._shape], self._ends[:-1])

    def _local(self, values: np.ndarray) -> list[np.ndarray]:
        """From the first corner of each block, so that far coordinates cost no digits."""
        return [each - each[0] for each in self._per_block(values)]

    def _at_centroids(self, values: np.ndarray) -> np.ndarray:
        """An affine function of the place at the centroid of each block: the mean over triangles by their areas."""
        result = np.empty((len(self), 2))
        for b, (x, v) in enumerate(zip(self._local(self._corners), self._per_block(values))):
            areas = _cross(x, np.roll(x, -1, axis=0))
            thirds = (v[0] + v + np.roll(v, -1, axis=0)) / 3.0
            result[b] = areas @ thirds / areas.sum()
        return result


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
