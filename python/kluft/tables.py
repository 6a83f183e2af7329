"""Tables as runs write them, CSV with a line of names, as NumPy structured arrays."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np

_COUNTS = frozenset("""step stage pass interface blocks block block_a block_b cracks_tension cracks_shear open sliding locked
    open_close_iterations crack_passes jumps replica""".split())
_FLAGS = frozenset(["balanced"])


def read_table(path: str | Path) -> np.ndarray:
    """The rows of a table, shape (n,), one field per column in the order of the file.

    Counts are int64, `balanced` is bool, other columns of numbers are float64 (nan where a cell is empty), all else is
    text. A last line without its end, which a killed run may leave, does not count.
    """
    return table_of(Path(path).read_text(encoding="utf-8"))


def table_of(text: str) -> np.ndarray:
    """The same from the text of a table."""
    rows = list(csv.reader(text[: text.rfind("\n") + 1].splitlines()))
    names = rows[0] if rows else []
    cells = list(zip(*rows[1:])) if len(rows) > 1 else [()] * len(names)
    columns = [_column(name, column) for name, column in zip(names, cells)]
    table = np.empty(max(len(rows) - 1, 0), dtype=[(name, column.dtype) for name, column in zip(names, columns)])
    for name, column in zip(names, columns):
        table[name] = column
    return table


def _column(name: str, cells: tuple[str, ...]) -> np.ndarray:
    if name in _FLAGS:
        return np.array([cell == "1" for cell in cells], dtype=bool)
    try:
        if name in _COUNTS:
            return np.array([int(cell) for cell in cells], dtype=np.int64)
        return np.array([float(cell) if cell else np.nan for cell in cells], dtype=np.float64)
    except ValueError:
        return np.array(cells, dtype=np.str_)


class Frames:
    """The tables of `owner` as pandas DataFrames, by the same names: `results.frames.history`."""

    def __init__(self, owner: Any) -> None:
        self._owner = owner

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return frame(getattr(self._owner, name))


def frame(table: np.ndarray) -> Any:
    """A structured array as a pandas DataFrame."""
    try:
        import pandas
    except ImportError as error:
        from .errors import missing

        raise missing("pandas", "a DataFrame") from error
    return pandas.DataFrame(table)
