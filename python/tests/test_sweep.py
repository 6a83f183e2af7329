import numpy as np
import pytest
from conftest import small_scene

import kluft


@pytest.fixture(scope="module")
def sweep(tmp_path_factory):
    scene = small_scene(**{"output.fields": False})
    vary = {"materials.sandstone.cohesion": ["5 MPa", "7 MPa"]}
    return scene.sweep(vary, tmp_path_factory.mktemp("sweep") / "cohesion", replicas=2, jobs=2)


def test_each_combination_is_a_row(sweep):
    assert len(sweep) == 4
    assert set(sweep.table["status"]) == {"done"}
    assert list(sweep.table["materials.sandstone.cohesion"]) == ["5 MPa", "5 MPa", "7 MPa", "7 MPa"]
    assert np.all(sweep.table["peak_stress"] > 0.0)


def test_a_case_that_fails_is_told(tmp_path):
    scene = small_scene(**{"output.fields": False})
    with pytest.warns(UserWarning, match="1 of 2 cases did not end as done: .* \\(no_equilibrium\\)"):
        scene.sweep({"solver.max_step_solves": [1, 20000]}, tmp_path / "sweep")


def test_cases_are_results(sweep):
    for case in range(len(sweep)):
        assert sweep[case].summary["peak_stress"] == sweep.table["peak_stress"][case]
    assert sweep.report.exists() and "<table>" in sweep._repr_html_()


def test_the_directory_of_a_study_opens_as_a_sweep(sweep):
    assert len(kluft.open(sweep.directory)) == 4


def test_a_mistyped_key_is_refused_before_anything_runs(tmp_path):
    with pytest.raises(kluft.InputError) as caught:
        small_scene().sweep({"materials.sandstone.cohesoin": [1e6]}, tmp_path / "sweep")
    assert caught.value.hint == "cohesion"
    assert not list((tmp_path / "sweep").glob("cases/*"))


def test_a_file_of_somebody_else_is_not_replaced(tmp_path):
    scene = small_scene()
    scene.to_yaml(tmp_path / "quickstart.yaml")
    with pytest.raises(kluft.InputError, match="would be lost"):
        scene.sweep({"stages.1.steps": [2]}, tmp_path)
    with pytest.raises(kluft.InputError, match="jobs"):
        scene.sweep({"stages.1.steps": [2]}, tmp_path / "other", jobs=0)


def test_an_unknown_case_of_the_validation_suite_is_refused():
    with pytest.raises(ValueError, match="did you mean 'incline'"):
        kluft.validate("inclin")
