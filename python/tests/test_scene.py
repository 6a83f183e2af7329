import os
import signal
import threading

import numpy as np
import pytest
from conftest import QUICKSTART, small_scene

import kluft


def test_values_are_read_and_set_by_paths(scene):
    assert scene["materials.sandstone.cohesion"] == "5 MPa"
    assert scene["materials.sandstone.poissons_ratio"] == 0.25
    assert scene["geometry.fractures.0.trace.1"] == ["14 cm", "27 cm"]
    scene["materials.sandstone.cohesion"] = "8 MPa"
    scene["stages.1.strain.value"] = np.float64(1e-6)
    assert scene["materials.sandstone.cohesion"] == "8 MPa" and scene["stages.1.strain.value"] == 1e-6
    assert "materials" in scene and "materials.granite" not in scene
    assert list(scene)[:2] == ["kluft", "title"]
    del scene["title"]
    assert "title" not in scene


def test_a_mistyped_key_is_refused_at_once_with_a_hint(scene):
    with pytest.raises(kluft.InputError) as caught:
        scene["materials.sandstone.cohesoin"] = "8 MPa"
    assert caught.value.path == "materials.sandstone.cohesoin"
    assert caught.value.hint == "cohesion"
    assert caught.value.line is None
    assert str(caught.value).startswith("materials.sandstone.cohesoin: expected one of density")
    scene.check()  # it is as it was
    with pytest.raises(kluft.InputError) as caught:
        scene["matrials.sandstone.cohesion"] = "8 MPa"
    assert caught.value.hint == "materials"


@pytest.mark.parametrize("key, value", [
    ("materials.sandstone.cohesion", "8 m"), ("materials.sandstone.cohesion", -1), ("stages.1.steps", 2.5),
    ("materials.sandstone.cohesion", float("nan")), ("analysis.plane", "strian"), ("geometry.domain.rectangle.width", None),
    ("stages.7.steps", 3), ("title", {"a": 1}), ("geometry.fractures", "none"),
])
def test_a_value_of_the_wrong_kind_is_refused_and_changes_nothing(scene, key, value):
    before = scene.to_dict()
    if key == "geometry.domain.rectangle.width":  # null removes it, and only the whole scene misses it
        scene[key] = value
        with pytest.raises(kluft.InputError, match="geometry.domain.rectangle.width"):
            scene.check()
        return
    with pytest.raises(kluft.InputError):
        scene[key] = value
    assert scene.to_dict() == before


def test_a_mapping_replaces_another_one(scene):
    scene["geometry.domain"] = {"polygon": np.array([[0, 0], [0.2, 0], [0.2, 0.4], [0, 0.4]])}
    assert list(scene["geometry.domain"]) == ["polygon"]
    scene["stages.0"] = {"name": "other", "pressure": {"0": "1 MPa"}}
    assert scene["stages.0.name"] == "other" and "stages.0.steps" not in scene and len(scene["stages"]) == 2
    before = scene.to_dict()
    with pytest.raises(kluft.InputError):
        scene["stages.0"] = {"nam": "other"}
    assert scene.to_dict() == before


def test_texts_stay_texts_and_numbers_in_quotes_are_none(scene):
    for title in ("null", "true", "a: b # c", "5 MPa", "= 5"):
        scene["title"] = title
        assert scene["title"] == title
    for number in ("5", "1e6", "nan"):
        with pytest.raises(kluft.InputError):
            scene["materials.sandstone.cohesion"] = number
    with pytest.raises(kluft.InputError, match="="):
        scene["stages.1.steps=3"] = 4
    with pytest.raises(TypeError):
        scene[5] = 3


def test_what_goes_together_may_be_set_one_by_one(scene):
    scene["materials.granite.density"] = 2650
    with pytest.raises(kluft.InputError, match="materials.granite.youngs_modulus"):
        scene.check()
    scene["materials.granite.youngs_modulus"] = "50 GPa"
    scene["materials.granite.poissons_ratio"] = 0.2
    scene["materials.granite.cohesion"] = scene["materials.granite.tensile_strength"] = "9 MPa"
    scene["materials.granite.friction_angle"] = 45
    assert scene["materials.granite.density"] == 2650


def test_an_error_in_a_file_has_its_place(tmp_path):
    file = tmp_path / "wrong.yaml"
    file.write_text(QUICKSTART.read_text().replace("youngs_modulus", "youngs_modulos"))
    with pytest.raises(kluft.InputError) as caught:
        kluft.Scene.from_yaml(file)
    error = caught.value
    line = next(number for number, text in enumerate(file.read_text().splitlines(), 1) if "modulos" in text)
    assert (error.path, error.file, error.line, error.hint) == (
        "materials.sandstone.youngs_modulos", str(file), line, "youngs_modulus")
    assert f"{file}:{line}:5: " in str(error)


def test_a_missing_file_is_refused_with_the_nearest():
    with pytest.raises(kluft.InputError) as caught:
        kluft.Scene.from_yaml(QUICKSTART.with_name("quikstart.yaml"))
    assert caught.value.hint == str(QUICKSTART)


def test_a_missing_key_is_a_key_error_with_a_hint(scene):
    with pytest.raises(KeyError, match="materials.sandstone.cohesion"):
        scene["materials.sandstone.cohesin"]
    assert scene.get("materials.granite") is None
    with pytest.raises(KeyError, match="stages.-1.steps"):
        scene["stages.-1.steps"]
    with pytest.raises(TypeError, match="a key of a scene is a text"):
        scene[5]


def test_a_mapping_is_a_scene_and_all_its_errors_come_at_once(scene):
    content = scene.to_dict()
    assert kluft.Scene(content).check().blocks == scene.check().blocks
    content["materials"]["sandstone"]["densty"] = content["materials"]["sandstone"].pop("density")
    content["stages"][0]["step"] = 2
    with pytest.raises(kluft.InputError) as caught:
        kluft.Scene(content)
    assert [(problem.path, problem.hint) for problem in caught.value.problems] == [
        ("materials.sandstone.densty", "density"), ("stages.0.step", "steps")]
    assert caught.value.line is None and "scene.yaml" not in str(caught.value)


def test_a_scene_written_and_read_is_the_same(scene, tmp_path):
    scene.to_yaml(tmp_path / "copy.yaml")
    assert kluft.Scene.from_yaml(tmp_path / "copy.yaml").to_dict() == scene.to_dict()


def test_a_copy_is_another_scene(scene):
    other = scene.copy()
    other["stages.1.steps"] = 5
    assert scene["stages.1.steps"] == 12


def test_check_says_what_the_program_says(scene):
    check = scene.check()
    assert check.blocks == len(scene.body()["ends"])
    assert check.unknowns == 6 * check.blocks
    assert ("blocks", str(check.blocks)) in [tuple(row) for row in check.table]
    assert str(check).startswith("scene        quickstart: Quick start")
    assert "<table>" in check._repr_html_()


def test_traces_are_added_inline_or_in_a_file(scene, tmp_path):
    trace = np.array([[-0.01, 0.3], [0.21, 0.35]])
    inline = scene.copy()
    inline.add_traces([trace], "joint")
    assert len(inline["geometry.fractures"]) == 2
    assert set(inline.body()["mapped_fracture"]) == {-1, 0, 1} and set(scene.body()["mapped_fracture"]) == {-1, 0}
    filed = scene.copy()
    filed.add_traces([trace], "joint", file=tmp_path / "traces.geojson")
    np.testing.assert_array_equal(filed.body()["corners"], inline.body()["corners"])
    with pytest.raises(kluft.InputError, match="trace 0"):
        scene.add_traces([[1.0, 2.0]], "joint")


def test_traces_come_from_a_geodataframe(scene):
    geopandas = pytest.importorskip("geopandas")
    from shapely.geometry import LineString, MultiLineString

    lines = [LineString([(-0.01, 0.3), (0.21, 0.35)]), MultiLineString([[(0.0, 0.05), (0.2, 0.06)]])]
    scene.add_traces(geopandas.GeoDataFrame(geometry=lines), "joint")
    assert len(scene["geometry.fractures"]) == 3
    scene.check()


def test_draw_shows_each_block(scene):
    axes = scene.draw()
    assert len(axes.collections[0].get_paths()) == scene.check().blocks


def test_a_run_is_that_of_the_program(scene, directory, tmp_path):
    rows = []
    results = scene.run(tmp_path / "run", on_step=rows.append)
    assert len(rows) == len(results.history) - 1
    by_program = kluft.open(directory)
    assert results.summary["blas_core"] != by_program.summary["blas_core"] or (
        results.summary["peak_stress"] == by_program.summary["peak_stress"])
    assert np.isclose(results.summary["peak_stress"], by_program.summary["peak_stress"], rtol=1e-6)
    assert results.status == "done" and (results.directory / "state.h5").exists()


def test_no_equilibrium_has_a_type_of_its_own_and_results(tmp_path):
    """A block on nothing."""
    scene = kluft.Scene({
        "kluft": 1, "analysis": {"gravity": 9.81}, "materials": {"rock": {"density": 2500, "youngs_modulus": 1e9, "poissons_ratio": 0.2}},
        "geometry": {"domain": {"rectangle": {"width": 1, "height": 1}}}, "stages": [{"name": "weight", "steps": 1}]}, name="falling")
    with pytest.raises(kluft.NoEquilibriumError) as caught:
        scene.run(tmp_path / "run")
    assert caught.value.results.status == "no_equilibrium"
    assert scene.run(tmp_path / "again", may_fail=True).status == "no_equilibrium"


def test_ctrl_c_ends_a_run_with_its_state_saved_and_it_can_be_resumed(scene, tmp_path):
    whole = scene.run(tmp_path / "whole")

    def interrupt(row):
        if row["step"] == 4:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        scene.run(tmp_path / "run", on_step=interrupt)
    cut = kluft.open(tmp_path / "run")
    assert cut.status == "interrupted" and 4 <= cut.history["step"][-1] <= 5
    resumed = scene.run(tmp_path / "run", resume=True)
    assert resumed.status == "done"
    assert np.isclose(resumed.summary["peak_stress"], whole.summary["peak_stress"], rtol=1e-2)


def test_a_directory_in_use_is_refused(scene, tmp_path):
    simulation = kluft.Simulation(scene, tmp_path / "run")
    next(simulation)
    with pytest.raises(kluft.InputError, match="run"):
        scene.run(tmp_path / "run")
    simulation.close()
    scene.run(tmp_path / "run")


def test_results_of_another_scene_are_replaced_by_force_only(scene, tmp_path):
    scene["stages.1.steps"] = 2
    scene.run(tmp_path / "run")
    scene.run(tmp_path / "run")
    scene["stages.1.steps"] = 3
    with pytest.raises(kluft.InputError, match="force=True"):
        scene.run(tmp_path / "run")
    assert scene.run(tmp_path / "run", force=True).status == "done"


def test_the_interpreter_is_free_while_a_scene_runs(tmp_path):
    counted, ended = [0], threading.Event()

    def count():
        while not ended.is_set():
            counted[0] += 1

    other = threading.Thread(target=count, daemon=True)
    other.start()
    try:
        small_scene().run(tmp_path / "run")
    finally:
        ended.set()
    other.join()
    assert counted[0] > 1000
