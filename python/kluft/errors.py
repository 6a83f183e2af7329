"""The errors of the package, one type for each way in which something ends badly."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NamedTuple, Sequence

#: Options of the program that messages name, and what they are here.
_ARGUMENTS = {"--force": "force=True", "--resume": "resume=True", " -o ": " output "}
_HINT = re.compile(r"did you mean '([^']*)'")


class Problem(NamedTuple):
    """One thing that is wrong with an input."""

    message: str  #: complete in itself: place, key, what was expected, what was found
    path: str  #: of the key, as in "materials.rock.cohesion"; "" where it is of none
    file: str  #: that says it; "" for what a program has set
    line: int | None  #: of the file, from 1
    column: int | None

    @property
    def hint(self) -> str:
        """The nearest valid name, or ""."""
        found = _HINT.search(self.message)
        return found.group(1) if found else ""


class InputError(ValueError):
    """Bad input: a scene, a study, a directory or an argument. All that is wrong is in the text, one message each.

    `problems` has them one by one; `path`, `line`, `file`, `column` and `hint` are those of the first.
    """

    def __init__(self, message: str, problems: Sequence[Problem] = (), **place: Any) -> None:
        super().__init__(message)
        fields: dict[str, Any] = {"path": "", "file": "", "line": None, "column": None, **place}
        self.problems: list[Problem] = list(problems) or [Problem(message, **fields)]

    @property
    def path(self) -> str:
        """The key that is wrong, as in "materials.rock.cohesion"; "" where it is none of a scene."""
        return self.problems[0].path

    @property
    def file(self) -> str:
        """The file that says it; "" for what a program has set."""
        return self.problems[0].file

    @property
    def line(self) -> int | None:
        """Line of the file, from 1; None without one."""
        return self.problems[0].line

    @property
    def column(self) -> int | None:
        return self.problems[0].column

    @property
    def hint(self) -> str:
        """The valid name that is nearest to what was found; "" where none is near."""
        return self.problems[0].hint


class _RunError(RuntimeError):
    """A run that did not get to its end. `results` is what it left, None where it left nothing."""

    def __init__(self, message: str, directory: Path | None = None) -> None:
        super().__init__(message)
        self._directory = directory

    @property
    def results(self) -> Any:
        from .results import Results

        return Results(self._directory) if self._directory is not None else None


class NoEquilibriumError(_RunError):
    """No equilibrium was found, or a stage ended out of balance; the text names the blocks concerned."""


class ResourceError(_RunError):
    """Disk or memory ran out. The last state that was committed is saved, where there was room for it."""


def input_error(problems: Sequence[tuple[str, str, str, str, int, int]]) -> InputError:
    """From what the library says: (message, what, path, file, line, column), 0 for no line. What stands in no file has no place
    but its key."""
    listed = []
    for message, what, path, file, line, column in problems:
        text = message if file or not what else f"{path}: {what}" if path else what
        for option, argument in _ARGUMENTS.items():
            text = text if file else text.replace(option, argument)
        listed.append(Problem(text, path, file, line or None, column or None))
    return together(listed)


def together(problems: Sequence[Problem]) -> InputError:
    """One error for all of them."""
    return InputError("\n".join(problem.message for problem in problems), problems)


def missing(package: str, purpose: str) -> ImportError:
    return ImportError(f"{purpose} needs {package}, which is not installed (Debian: python3-{package})")
