"""Compares two keepings byte for byte, but for times and memory."""

import csv
import json

import keeping
from kept import TABLES

# What the clock and the machine say. Everything else has to be equal to the last digit.
COLUMNS_OF_TIME = {"elapsed_s", "cpu_s"}
KEYS_OF_TIME = {"elapsed_s", "loading_cpu_s", "cpu_s", "peak_memory_bytes", "version"}
PREFIX_OF_TIME = "seconds."


def runs_in(directory):
    return {str(file.parent.relative_to(directory)): file.parent for file in directory.rglob("run.json")}


def mode_of(directory):
    try:
        return json.loads((directory / keeping.MARK).read_text(encoding="utf-8"))["mode"]
    except (OSError, ValueError, KeyError):
        raise keeping.BadUse(f"{directory}: expected a directory that 'run keep' has written") from None


# ---- files as cells: (line, column) -> text ----------------------------------------------------------------------


def cells_of_csv(path):
    """The first line as it stands, then each cell but those of times, by line and column."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    cells = {(1, "head"): ",".join(rows[0])} if rows else {}
    for line, row in enumerate(rows[1:], 2):
        for i, cell in enumerate(row):
            name = rows[0][i] if i < len(rows[0]) else f"column {i + 1}"
            if name not in COLUMNS_OF_TIME:
                cells[line, name] = cell
    return cells


def leaves(value, path=""):
    """A tree of JSON as pairs of a path and a text."""
    if isinstance(value, dict):
        for key, item in value.items():
            yield from leaves(item, f"{path}.{key}" if path else key)
    elif isinstance(value, list):
        for i, item in enumerate(value):
            yield from leaves(item, f"{path}.{i}")
    else:
        yield path, value if isinstance(value, str) else json.dumps(value)


def cells_of_json(path):
    """The values by their keys, whose order means nothing."""
    tree = json.loads(path.read_text(encoding="utf-8"), parse_float=str, parse_int=str)
    pairs = [(key, text) for key, text in leaves(tree) if key not in KEYS_OF_TIME and not key.startswith(PREFIX_OF_TIME)]
    return {(number, key): text for number, (key, text) in enumerate(sorted(pairs), 1)}


def cells_of_text(path):
    lines = path.read_text(encoding="utf-8", errors="replace").splitlines()
    return {(number, "text"): line for number, line in enumerate(lines, 1)}


def cells_of(path):
    try:
        return {".csv": cells_of_csv, ".json": cells_of_json}.get(path.suffix, cells_of_text)(path)
    except (ValueError, UnicodeDecodeError):
        return cells_of_text(path)


# ---- differences -------------------------------------------------------------------------------------------------


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return None


def relative_difference(a, b):
    largest = max(abs(a), abs(b))
    return abs(a - b) / largest if largest > 0 else 0.0


def largest_difference(first, second, column):
    """The largest relative difference of the numbers of a column that both files have; None without such numbers."""
    pairs = [(number(text), number(second.get(key))) for key, text in first.items() if key[1] == column]
    return max((relative_difference(a, b) for a, b in pairs if a is not None and b is not None), default=None)


def shown(text):
    return "nothing" if text is None else text if len(text) <= 60 else text[:57] + "..."


def difference_of_files(first, second):
    """What differs first in two files, as a text; empty where nothing does."""
    if not (first.exists() and second.exists()):
        return "" if first.exists() == second.exists() else f"only in {'A' if first.exists() else 'B'}"
    a, b = cells_of(first), cells_of(second)
    if a == b:
        return ""
    places = sorted({key for key in {*a, *b} if a.get(key) != b.get(key)}, key=lambda key: key[0])
    line = places[0][0]
    order = [key for key in [*a, *b] if key[0] == line and a.get(key) != b.get(key)]
    key = order[0]
    text = f"line {line}, {key[1]}: {shown(a.get(key))} | {shown(b.get(key))}"
    largest = largest_difference(a, b, key[1])
    if largest is not None:
        text += f", largest relative difference in that column {largest:.1e}"
    lines_a, lines_b = max((k[0] for k in a), default=0), max((k[0] for k in b), default=0)
    return text + (f", {lines_a} and {lines_b} lines" if lines_a != lines_b else "")


def difference_of_runs(first, second):
    names = sorted({file.name for place in (first, second) for file in place.iterdir() if file.is_file()},
                   key=lambda name: (name != "run.json", name not in TABLES, name))
    found = [(name, text) for name in names if (text := difference_of_files(first / name, second / name))]
    if not found:
        return ""
    others = f" (and in {', '.join(name for name, _ in found[1:])})" if len(found) > 1 else ""
    return f"{found[0][0]}: {found[0][1]}{others}"


def compare(options):
    for directory in (options.first, options.second):
        if not directory.is_dir():
            raise keeping.BadUse(f"{directory}: no such directory")
    modes = mode_of(options.first), mode_of(options.second)
    if modes[0] != modes[1]:
        raise keeping.BadUse(f"cannot compare: {options.first} was kept with --mode {modes[0]}, {options.second} with --mode {modes[1]}")
    first, second = ({name: place for name, place in runs_in(directory).items() if keeping.matches(name, options.only)}
                     for directory in (options.first, options.second))
    names = sorted({*first, *second})
    if not names:
        raise keeping.BadUse("there is nothing to compare")
    n_equal = n_different = n_missing = 0
    width = max(map(len, names))
    for name in names:
        if name not in first or name not in second:
            n_missing += 1
            print(f"{name:{width}}  missing in {'A' if name not in first else 'B'}")
            continue
        difference = difference_of_runs(first[name], second[name])
        n_different += bool(difference)
        n_equal += not difference
        if difference or not options.brief:
            print(f"{name:{width}}  {'differs: ' + difference if difference else 'equal'}")
    print(f"\n{len(names)} runs: {n_equal} equal, {n_different} different, {n_missing} missing on one side")
    return 0 if n_equal == len(names) else 1
