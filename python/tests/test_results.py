import json
import re
import zlib

import numpy as np
import pytest
from conftest import small_scene

import kluft
from kluft.vtu import data_arrays


def test_a_run_without_a_platen_has_no_peak(tmp_path):
    scene = small_scene()
    scene["stages"] = [{"name": "pressure", "pressure": {"left": "1 MPa", "right": "1 MPa", "top": "1 MPa"}}]
    results = scene.run(tmp_path / "pressed")
    assert not results.moves_platen
    with pytest.raises(kluft.InputError, match="a peak of the axial stress"):
        results.fields("peak")


def test_tables_have_the_rows_and_columns_of_the_files(results, directory):
    lines = (directory / "history.csv").read_text().splitlines()
    assert results.history.dtype.names == tuple(lines[0].split(","))
    assert len(results.history) == len(lines) - 1
    assert results.history["step"].dtype == np.int64 and results.history["balanced"].dtype == bool
    assert results.history["axial_stress"][3] == float(lines[4].split(",")[lines[0].split(",").index("axial_stress")])
    assert len(results.cracks) == results.summary["cracks_tension"] + results.summary["cracks_shear"]
    assert set(results.cracks["mode"]) <= {"tension", "shear"}
    assert len(results.jumps) == results.summary["jumps"]


def test_summary_is_the_file(results, directory):
    assert results.summary == json.loads((directory / "summary.json").read_text())
    assert results.status == "done"


def test_peak_is_the_row_of_the_largest_axial_stress(results):
    assert results.peak["axial_stress"] == results.summary["peak_stress"]
    assert results.peak["axial_strain"] == results.summary["peak_strain"]


def test_a_last_line_that_was_cut_does_not_count(results, directory, tmp_path):
    text = (directory / "history.csv").read_text()
    (tmp_path / "history.csv").write_text(text + text.splitlines()[-1][:30])
    assert len(kluft.open(tmp_path).history) == len(results.history)
    assert kluft.open(tmp_path).status == "unfinished"


def test_frames_are_the_tables(results):
    pandas = pytest.importorskip("pandas")
    assert isinstance(results.frames.history, pandas.DataFrame)
    assert list(results.frames.cracks.columns) == list(results.cracks.dtype.names)


@pytest.mark.parametrize("make, message", [
    (lambda path: path, "found nothing"),
    (lambda path: path.mkdir() or path, "no history.csv"),
    (lambda path: path.write_text("") and path or path, "found a file"),
])
def test_what_is_no_directory_of_results_is_refused(tmp_path, make, message):
    with pytest.raises(kluft.InputError, match=message):
        kluft.open(make(tmp_path / "nothing"))


def test_a_mistyped_directory_has_a_hint(directory):
    with pytest.raises(kluft.InputError) as caught:
        kluft.open(directory.with_name("smal"))
    assert caught.value.hint == str(directory)


def test_fields_are_those_of_the_step(results):
    fields = results.fields()
    assert fields.step == results.steps[-1] == results.history["step"][-1]
    assert len(fields) == results.summary["blocks"] == len(fields.polygons) == len(fields.stress)
    assert fields.stress.shape == (len(fields), 2, 2)
    assert np.isclose(fields.areas.sum(), 0.2 * 0.4, rtol=1e-12)  # of the specimen, m2
    assert len(fields.interfaces) == results.summary["interfaces"]


def test_stresses_are_positive_in_compression_and_in_balance_with_the_pressure(results):
    """The mean stress over a body under 1 MPa all around is 1 MPa, whatever the blocks: the end of the first stage."""
    fields = results.fields(2)
    mean = np.einsum("n,nij->ij", fields.areas, fields.stress) / fields.areas.sum()
    np.testing.assert_allclose(mean, 1e6 * np.eye(2), atol=1e3)
    np.testing.assert_allclose(fields.sigma_1, np.linalg.eigvalsh(fields.stress)[:, 1], rtol=1e-9)
    assert np.all(fields.interfaces["normal_traction"][fields.interfaces["bonded"]] > 0.0)


def test_displacements_at_centroids_are_those_of_an_affine_motion(results):
    """A block moves affinely: the least-squares fit to its corners has no residual, and gives the motion of its centroid."""
    fields = results.fields()
    for polygon, moves, centroid, found in zip(fields.polygons, fields.displacements, fields.centroids, fields.displacement):
        matrix = np.column_stack([np.ones(len(polygon)), polygon - centroid])
        fit = np.linalg.lstsq(matrix, moves, rcond=None)[0]
        np.testing.assert_allclose(matrix @ fit, moves, atol=1e-12)
        np.testing.assert_allclose(fit[0], found, atol=1e-12)


def test_normals_of_interfaces_point_from_block_a_to_block_b(results):
    fields = results.fields(0)
    faces = fields.interfaces
    middles = np.column_stack([faces["x"], faces["y"]])
    normals = np.column_stack([faces["normal_x"], faces["normal_y"]])
    for side, sign in (("block_a", -1.0), ("block_b", 1.0)):
        away = fields.centroids[faces[side]] - middles
        assert np.all(sign * np.sum(away * normals, axis=1) > 0.0)  # triangles and pieces of them are convex


def test_contacts_carry_tractions(results):
    contacts = results.fields().contacts
    assert {"block_a", "block_b", "x", "y", "normal_traction", "shear_traction"} <= set(contacts.dtype.names)
    assert len(contacts) > 0


def test_the_state_at_the_peak_is_kept_and_carries_its_stress(results):
    fields = results.fields("peak")
    row = results.history[results.history["step"] == fields.step][0]
    assert np.abs(row["axial_stress"]) == np.abs(results.history["axial_stress"][results.history["balanced"]]).max()
    corners = [(polygon, np.roll(polygon, -1, axis=0)) for polygon in fields.deformed()]
    areas = np.array([0.5 * np.sum(a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]) for a, b in corners])
    # Mean stress of a body in equilibrium is that of the forces on its boundary; cracks that have opened are no part of it.
    assert np.isclose(areas @ fields.stress[:, 1, 1] / areas.sum(), row["axial_stress"], rtol=0.01)


def test_a_film_has_a_picture_of_each_kept_state(results, tmp_path):
    from PIL import Image

    with Image.open(results.animate(tmp_path / "film.gif", fps=2)) as film:
        assert film.n_frames == len(results.steps)
        assert film.info["duration"] == 500  # ms


def test_a_step_that_was_not_kept_is_refused_with_those_that_were(results):
    with pytest.raises(kluft.InputError, match=re.escape(str(results.steps[0]))):
        results.fields(1)


def test_plots_show_curve_and_blocks(results):
    axes = results.plot()
    assert axes.get_xlabel() == "axial strain (%)"
    highest = max(np.max(line.get_ydata()) for line in axes.lines)
    assert np.isclose(highest, 1e-6 * results.equilibria["differential_stress"].max())
    axes = results.fields().plot("displacement", scale=10)
    assert len(axes.collections[0].get_paths()) == results.summary["blocks"]
    with pytest.raises(kluft.InputError) as caught:
        results.fields().plot("sigma1")
    assert caught.value.hint == "sigma_1"


def test_a_notebook_shows_the_headline(results):
    text = results._repr_html_()
    assert "peak axial stress" in text and "data:image/png" in text


def test_compressed_arrays_are_read_like_plain_ones(tmp_path):
    """As VTK compresses: number of pieces, size of one, size of the last, compressed sizes, pieces of 16 bytes here."""
    values = np.arange(5.0)
    pieces = [values.tobytes()[at : at + 16] for at in range(0, 40, 16)]
    packed = [zlib.compress(piece) for piece in pieces]
    sizes = np.array([3, 16, 8, *map(len, packed)], dtype="<u8").tobytes()
    plain = np.array([40], dtype="<u8").tobytes() + values.tobytes()
    for attribute, data in (('compressor="vtkZLibDataCompressor" ', sizes + b"".join(packed)), ("", plain)):
        head = (f'<VTKFile byte_order="LittleEndian" {attribute}header_type="UInt64"><UnstructuredGrid><Piece><CellData>'
                '<DataArray type="Float64" Name="x" offset="0"/></CellData></Piece></UnstructuredGrid>'
                '<AppendedData encoding="raw">\n_')
        np.testing.assert_array_equal(data_arrays(head.encode() + data)["CellData"]["x"], values)


def test_vtk_reads_the_same(results):
    pytest.importorskip("vtkmodules")
    fields = results.fields()
    grid = fields.to_vtk()
    assert grid.GetNumberOfCells() == len(fields)
    assert fields.to_vtk("interfaces").GetNumberOfCells() == len(fields.interfaces)


def test_geopandas_has_the_areas(results):
    pytest.importorskip("geopandas")
    table = results.fields().to_geopandas(scale=0.0)
    np.testing.assert_allclose(table.area, table["area"], rtol=1e-9)
