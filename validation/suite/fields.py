"""Fields of a load step as cases look at them."""

import sys
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[2] / "python"))  # its readers need NumPy only

from kluft.vtu import data_arrays  # noqa: E402


class Fields:
    """Blocks (polygons) or interfaces (lines) of one load step.

    points: (n, 2) before loading; displacement: (n, 2); cells: a list of arrays of point indices; field["stress_xx"]: one
    number per cell. Units are those of the file. Stress and normal traction are positive in tension here, as in mechanics; the file has
    them positive in compression.
    """

    def __init__(self, path):
        sections = data_arrays(path)
        self.points = sections["Points"]["Points"][:, :2]
        self.displacement = sections["PointData"]["displacement"][:, :2]
        self.field = sections["CellData"]
        if "stress" in self.field:
            tensor = -self.field.pop("stress")
            self.field.update(stress_xx=tensor[:, 0], stress_xy=tensor[:, 1], stress_yy=tensor[:, 4])
        if "normal_traction" in self.field:
            self.field["normal_traction"] = -self.field["normal_traction"]
        shapes = sections["Cells"]
        self.cells = np.split(shapes["connectivity"], shapes["offsets"][:-1])

    def __getitem__(self, name):
        return self.field[name]

    def __len__(self):
        return len(self.cells)

    def middles(self):
        """Mean of the corners of each cell before loading, (n, 2): the centroid of a regular hexagon and of a line."""
        return np.array([self.points[cell].mean(axis=0) for cell in self.cells])

    def mean_displacements(self):
        """Mean displacement of the corners of each cell, (n, 2): blocks move affinely."""
        return np.array([self.displacement[cell].mean(axis=0) for cell in self.cells])

    def gradients(self):
        """Displacement gradient of each block, (n, 2, 2): [i, j] = du_i/dx_j."""
        result = []
        for cell in self.cells:
            x = self.points[cell] - self.points[cell].mean(axis=0)
            u = self.displacement[cell] - self.displacement[cell].mean(axis=0)
            result.append(np.linalg.lstsq(x, u, rcond=None)[0].T)
        return np.array(result)

    def areas(self):
        result = []
        for cell in self.cells:
            x, y = self.points[cell].T
            result.append(0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))
        return np.array(result)

    def lengths(self):
        """Of lines."""
        return np.array([np.linalg.norm(self.points[cell[1]] - self.points[cell[0]]) for cell in self.cells])

    def angles(self):
        """Direction of each line's normal in degrees, 0 <= angle < 180."""
        result = []
        for cell in self.cells:
            along = self.points[cell[1]] - self.points[cell[0]]
            result.append(np.degrees(np.arctan2(-along[0], along[1])) % 180.0)
        return np.array(result)

    def nearest(self, point):
        """Index of the cell whose middle is nearest to the point."""
        return int(np.argmin(np.linalg.norm(self.middles() - np.asarray(point), axis=1)))

