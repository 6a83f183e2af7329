"""The program kluft, which runs the cases of sweeps and the validation suite in processes of their own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from .errors import ResourceError


def program() -> Path:
    """The program: that of the variable KLUFT_PROGRAM, that installed with the package, that of the build the package stands in,
    or that of the PATH. Throws ResourceError where there is none."""
    here = Path(__file__).parent
    found = [os.environ.get("KLUFT_PROGRAM"), here / "bin" / "kluft", here.parent.parent / "kluft", shutil.which("kluft")]
    for place in found:
        if place and Path(place).is_file() and os.access(place, os.X_OK):
            return Path(place).absolute()
    raise ResourceError("the program kluft was not found; KLUFT_PROGRAM can name it")


def main() -> None:
    """`python3 -m kluft ...` is `kluft ...`."""
    path = str(program())
    sys.stdout.flush()
    os.execv(path, [path, *sys.argv[1:]])


def validate(*cases: str, output: str | Path = "results/validation", jobs: int = 1) -> bool:
    """Runs the validation suite, or some of its cases, as `kluft validate` does: True if all are within tolerance. What each case
    came to is in report.md in `output`. Throws ValueError for an unknown case."""
    command = [str(program()), "validate", *cases, "-o", str(output), "--jobs", str(jobs)]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode not in (0, 1):
        raise ValueError(done.stdout.strip())
    return done.returncode == 0
