"""One line that says where a run stands."""

from __future__ import annotations

import sys
import time


class ProgressLine:
    """On standard error: on a terminal and in a notebook one line that is rewritten, elsewhere one every 10 s."""

    def __init__(self) -> None:
        self._rewrites = sys.stderr.isatty() or "ipykernel" in sys.modules
        self._last = ""
        self._when = 0.0

    def show(self, text: str) -> None:
        pause = 0.2 if self._rewrites else 10.0
        if not text or text == self._last or (time.monotonic() - self._when < pause and not text.startswith("stopping")):
            return
        self._write(f"\r{text.ljust(len(self._last))}" if self._rewrites else f"{text}\n")
        self._last, self._when = text, time.monotonic()

    def clear(self) -> None:
        if self._rewrites and self._last:
            self._write(f"\r{' ' * len(self._last)}\r")

    @staticmethod
    def _write(text: str) -> None:
        sys.stderr.write(text)
        sys.stderr.flush()
