"""What the tests share: a small scene, its results by the program, no windows."""

import os
import subprocess
from pathlib import Path

import matplotlib
import pytest

import kluft
from kluft.program import program

matplotlib.use("Agg")

ROOT = Path(__file__).resolve().parents[2]
QUICKSTART = ROOT / "models" / "quickstart.yaml"
#: A specimen of few blocks and load steps.
SMALL = {"geometry.tessellation.triangles.spacing": "5 cm", "stages.1.steps": 12, "output.pictures": False}


def small_scene(**more):
    scene = kluft.Scene.from_yaml(QUICKSTART)
    for key, value in {**SMALL, **more}.items():
        scene[key] = value
    return scene


@pytest.fixture
def scene():
    return small_scene()


@pytest.fixture(scope="session")
def directory(tmp_path_factory):
    """Results of the small scene, of every fourth load step, by the program itself."""
    directory = tmp_path_factory.mktemp("results") / "small"
    settings = [f"{key}={value}" for key, value in {**SMALL, "output.fields_every": 4, "output.pictures": "true"}.items()]
    command = [program(), "run", QUICKSTART, "-o", directory, "--quiet", *(word for each in settings for word in ("--set", each))]
    subprocess.run([str(word) for word in command], check=True, env={**os.environ})
    return directory


@pytest.fixture
def results(directory):
    return kluft.open(directory)
