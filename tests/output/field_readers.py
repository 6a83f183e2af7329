"""Another program reads the field files of a run as the project's own reader does, names and units included.

usage: field_readers.py Meshio|Vtk KLUFT WORK_DIRECTORY
"""

import shutil
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
NOT_INSTALLED = 77
sys.dont_write_bytecode = True
sys.path.append(str(ROOT / "validation/suite"))
from fields import data_arrays  # noqa: E402


def with_meshio(path):
    """(points, {point data}, {cell data}, {field data}, kinds of cells)."""
    import meshio
    mesh = meshio.read(path)
    cells = {name: np.concatenate(parts) for name, parts in mesh.cell_data.items()}
    return mesh.points, mesh.point_data, cells, mesh.field_data, [block.type for block in mesh.cells]


def with_vtk(path):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()

    def arrays(data):
        return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}

    kinds = {grid.GetCell(i).GetClassName() for i in range(grid.GetNumberOfCells())}
    return (vtk_to_numpy(grid.GetPoints().GetData()), arrays(grid.GetPointData()), arrays(grid.GetCellData()),
            arrays(grid.GetFieldData()), kinds)


READERS = {"Meshio": ("meshio", with_meshio), "Vtk": ("vtkmodules", with_vtk)}


def problems_of(path, read):
    points, at_points, at_cells, names, kinds = read(path)
    own = data_arrays(path)
    part = path.name.split("_")[0]
    order = np.argsort(at_cells[part[:-1]], kind="stable")  # block, interface: numbers that the file has in order
    if not np.array_equal(points, own["Points"]["Points"]):
        yield f"{path.name}: other points"
    for found, known, rows in ((at_points, own["PointData"], slice(None)), (at_cells, own["CellData"], order)):
        for name, array in known.items():
            if name not in found or not np.array_equal(np.asarray(found[name])[rows].reshape(array.shape), array):
                yield f"{path.name}: another {name}"
    shapes = {name: at_cells[name].shape[1:] for name in ("stress", "relative_displacement", "contact_force") if name in at_cells}
    expected = {"stress": (9,)} if part == "blocks" else {"relative_displacement": (3,), "contact_force": (3,)}
    if shapes != expected:
        yield f"{path.name}: expected {expected}, found {shapes}"
    wanted = {"blocks": {"material: sandstone": 0, "unit of stress: Pa, positive in compression": 1},
              "interfaces": {"mapped_fracture: inclined": 0, "interface_type: rock_bond": 1, "state: locked": 2}}[part]
    for name, value in wanted.items():
        if name not in names or int(np.ravel(names[name])[0]) != value:
            yield f"{path.name}: expected the field data '{name}' = {value}, found {sorted(names)}"
    if not all("olygon" in kind or "ine" in kind or "riangle" in kind for kind in kinds):
        yield f"{path.name}: cells are {kinds}"


def problems_of_series(out):
    """The files that fields.pvd names are there, and its times increase."""
    sets = ElementTree.parse(out / "fields.pvd").findall("Collection/DataSet")
    times = [float(each.get("timestep")) for each in sets if each.get("part") == "0"]
    if len(times) < 3 or sorted(set(times)) != times:
        yield f"times {times}"
    yield from (f"no {each.get('file')}" for each in sets if not (out / each.get("file")).exists())


def main(name, kluft, work):
    module, read = READERS[name]
    try:
        __import__(module)
    except ImportError:
        print(f"{module} is not installed")
        return NOT_INSTALLED
    out = Path(work) / "out"
    shutil.rmtree(work, ignore_errors=True)
    subprocess.run([kluft, "run", ROOT / "models/quickstart.yaml", "-o", out, "--quiet", "--set", "output.pictures=false",
                    "--set", "geometry.tessellation.triangles.spacing=0.05", "--set", "stages.1.steps=10"], check=True)
    files = sorted((out / "fields").glob("*.vtu"))
    problems = [problem for path in files for problem in problems_of(path, read)] + list(problems_of_series(out))
    print("\n".join(problems) or f"{len(files)} files are read")
    return 1 if problems or not files else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
