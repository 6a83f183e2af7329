"""Balances every block of kept states by what contacts/<step>.csv and supports/<step>.csv say alone.

usage: validation/balance/run DIR... [--tolerance 0.001]

On block a of a contact acts length (-normal_traction n + shear_traction t) at (x, y), on block b the opposite at (x_b, y_b), with
n = (normal_x, normal_y) and t = n turned by +90 degrees; the forces of supports/ act on their block as they stand. What is left
over on a block is the larger of |sum of forces| and |sum of moments| over its size, in units of its own forces: its weight and the
resultant of its pressures and point forces, or where it has none the magnitudes of its contact forces. A loose block without loads
that comes to rest may have nothing but what is left over on it: less than a tenth of the tolerance times the largest own forces of
the blocks that it meets disturbs nobody, and counts as a share of those. Exit code 1 where more is left over than the tolerance, 2 for
bad input.
"""

import argparse
import csv
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np

NUMBERS = {"contacts": ["block_a", "block_b", "x", "y", "length", "normal_x", "normal_y", "normal_traction", "shear_traction", "x_b", "y_b"],
           "supports": ["block", "fx", "fy", "x", "y"]}
STATES = {"bonded", "locked", "sliding", "open"}
LOADS = {"weight", "pressure", "force"}
REACTIONS = {"platen", "support", "fixed"}
HARMLESS = 0.1  # of the tolerance times the forces around: what may be left over on a block without loads
TOLERANCE = 1e-3
LEAST_FORCE = 1e-9  # of the largest on any block: a block with less has none


class BadInput(Exception):
    pass


def read_table(path, numbers):
    """{column: array of numbers or of words}."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = csv.reader(file)
        names = next(rows, [])
        columns = list(zip(*rows, strict=True)) or [()] * len(names)
    table = {name: np.array(column) for name, column in zip(names, columns, strict=True)}
    missing = [name for name in numbers if name not in table]
    if missing:
        raise BadInput(f"{path}: no column '{missing[0]}'")
    for name in numbers:
        table[name] = table[name].astype(float)
    return table


@dataclass
class Balance:
    """Of one kept state. Per block that a force acts on: N per metre of thickness, and shares of its own forces."""

    block: np.ndarray
    own: np.ndarray
    left: np.ndarray  # the larger of force and moment over size
    share: np.ndarray

    @property
    def worst(self):
        """Index of the block of the largest share."""
        return int(np.argmax(self.share))

    @property
    def largest(self):
        return float(self.share.max(initial=0.0))


def forces_of(directory, step):
    """(block, force (n, 2), place (n, 2), kind) of all forces of a state; kind: contact, or as supports/ has it."""
    path = directory / "contacts" / f"{step:06}.csv"
    table = read_table(path, NUMBERS["contacts"])
    unknown = set(table["state"]) - STATES
    if unknown:
        raise BadInput(f"{path}: expected a state of {sorted(STATES)}, found '{unknown.pop()}'")
    normal = np.column_stack([table["normal_x"], table["normal_y"]])
    tangent = np.column_stack([-table["normal_y"], table["normal_x"]])
    on_a = table["length"][:, None] * (-table["normal_traction"][:, None] * normal + table["shear_traction"][:, None] * tangent)
    path = directory / "supports" / f"{step:06}.csv"
    outside = read_table(path, NUMBERS["supports"])
    unknown = set(outside["kind"]) - LOADS - REACTIONS
    if unknown:
        raise BadInput(f"{path}: expected a kind of {sorted(LOADS | REACTIONS)}, found '{unknown.pop()}'")
    block = np.concatenate([table["block_a"], table["block_b"], outside["block"]]).astype(int)
    force = np.concatenate([on_a, -on_a, np.column_stack([outside["fx"], outside["fy"]])])
    place = np.concatenate([np.column_stack([table["x"], table["y"]]), np.column_stack([table["x_b"], table["y_b"]]),
                            np.column_stack([outside["x"], outside["y"]])])
    kind = np.concatenate([np.full(2 * len(on_a), "contact"), outside["kind"].astype(str)])
    return block, force, place, kind


def largest_around(row, n_contacts, own):
    """The largest own forces of the blocks that each block meets, and its own. `row`: of all forces, those of contacts on side a and
    then on side b first."""
    a, b = row[:n_contacts], row[n_contacts:2 * n_contacts]
    around = own.copy()
    np.maximum.at(around, a, own[b])
    np.maximum.at(around, b, own[a])
    return around


def balance_of(directory, step, tolerance=TOLERANCE):
    owner, force, place, kind = forces_of(Path(directory), step)
    block, row = np.unique(owner, return_inverse=True)
    n = len(block)

    def sums(values, chosen=slice(None)):
        return np.bincount(row[chosen], values[chosen], n)

    magnitude = np.hypot(*force.T)
    count = np.maximum(np.bincount(row, minlength=n), 1)
    middle = np.column_stack([sums(place[:, i]) / count for i in (0, 1)])
    arm = place - middle[row]
    reach = np.sqrt(sums((arm**2).sum(axis=1)) / count)  # of the places where forces act: about 0.4 of a square's side to 0.6
    moment = sums(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])
    size = np.where(reach > 0.0, 2.0 * reach, 1.0)
    left = np.maximum(np.hypot(sums(force[:, 0]), sums(force[:, 1])), np.abs(moment) / size)
    surface = np.isin(kind, ["pressure", "force"])
    loads = sums(magnitude, kind == "weight") + np.hypot(sums(force[:, 0], surface), sums(force[:, 1], surface))
    of_contacts = sums(magnitude, kind == "contact")
    everything = sums(magnitude)
    has_loads = loads > 1e-3 * everything
    own = np.where(has_loads, loads, of_contacts)
    own = np.where(own > 0.0, own, everything)
    around = largest_around(row, int(np.sum(kind == "contact")) // 2, own)
    own = np.where(~has_loads & (left <= HARMLESS * tolerance * around), around, own)
    counts = own > LEAST_FORCE * everything.max(initial=0.0)
    share = np.divide(left, own, out=np.zeros(n), where=counts)
    return Balance(block, own, left, share)


def kept_steps(directory):
    steps = sorted(int(path.stem) for path in (Path(directory) / "contacts").glob("*.csv"))
    if not steps:
        raise BadInput(f"{directory}: expected results with contacts/<step>.csv in them, found none (output.fields: true keeps them)")
    return steps


def history_of(directory):
    """{step: row} of history.csv; empty where there is none."""
    path = Path(directory) / "history.csv"
    if not path.exists():
        return {}
    with open(path, newline="", encoding="utf-8") as file:
        return {int(row["step"]): row for row in csv.DictReader(file)}


def main(words):
    parser = argparse.ArgumentParser(description="Balances every block of kept states by contacts/ and supports/ alone.")
    parser.add_argument("directories", nargs="+", metavar="DIR")
    parser.add_argument("--tolerance", type=float, default=TOLERANCE, help="largest share of a block's own forces that may be left over")
    arguments = parser.parse_args(words)
    balanced = True
    for directory in arguments.directories:
        history = history_of(directory)
        for step in kept_steps(directory):
            found = balance_of(directory, step, arguments.tolerance)
            if len(found.block) == 0:
                print(f"{directory} step {step}: no forces")
                continue
            worst = found.worst
            said = f"; history.csv: {history[step]['balance_error']}" if step in history else ""
            print(f"{directory} step {step}: {found.largest:.3g} of its own {found.own[worst]:.4g} N/m left over on block "
                  f"{found.block[worst]}{said}")
            balanced = balanced and found.largest <= arguments.tolerance
    return 0 if balanced else 1


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except (BadInput, OSError, ValueError) as error:
        print(error, file=sys.stderr)
        sys.exit(2)
