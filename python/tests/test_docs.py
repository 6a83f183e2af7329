"""The code in docs/python.md does what it says."""

import re

import pytest
from conftest import QUICKSTART, ROOT, SMALL

import kluft

PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


@pytest.mark.filterwarnings("ignore")
def test_every_block_of_the_page_runs(tmp_path, monkeypatch, capsys):
    """One after the other in one place, with fewer blocks and load steps than the scene of the page has."""
    (tmp_path / "models").mkdir()
    small = kluft.Scene.from_yaml(QUICKSTART)
    for key, value in SMALL.items():
        small[key] = value
    small.to_yaml(tmp_path / "models" / "quickstart.yaml")
    monkeypatch.chdir(tmp_path)
    names = {}
    assert len(BLOCKS) >= 7
    for block in BLOCKS:
        exec(compile(without_pandas(block), "docs/python.md", "exec"), names)
    said = capsys.readouterr().out
    assert "MPa" in said and "materials.sandstone.cohesoin None cohesion" in said
    assert names["simulation"].status in ("done", "collapsed")


def without_pandas(block):
    """The line that needs pandas is left out where there is none."""
    try:
        import pandas  # noqa: F401
    except ImportError:
        return "\n".join(line for line in block.splitlines() if ".frames." not in line)
    return block
