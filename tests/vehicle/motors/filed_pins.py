"""gpiozero's simulated pins, kept in a file, so that they outlive the process which drives them, as real pins do.

gpiozero finds the factory by name through entry points, in any process: see `installed`.
"""

from __future__ import annotations

import fcntl
import math
import mmap
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from gpiozero.pins.mock import MockFactory, MockPWMPin

FACTORY = "filed"
WHERE = "FILED_PINS"
"""Environment variable: the file. Each pin has two bytes: its function, and its level or duty in 1/255, rounded up."""
FUNCTIONS = (None, "input", "output")
"""None: never used."""
PINS = 28


class Header:
    """The pins, seen from any process."""

    def __init__(self, path: Path) -> None:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o600)
        os.ftruncate(descriptor, 2 * PINS)
        self._bytes = mmap.mmap(descriptor, 2 * PINS)
        os.close(descriptor)

    def function(self, number: int) -> str | None:
        return FUNCTIONS[self._bytes[2 * number]]

    def level(self, number: int) -> float:
        return self._bytes[2 * number + 1] / 255

    def keep(self, number: int, function: str, level: float) -> None:
        self._bytes[2 * number : 2 * number + 2] = bytes([FUNCTIONS.index(function), math.ceil(level * 255)])

    def hold(self, number: int, *, high: bool) -> None:
        """Something outside, as a button, gives an input its level."""
        assert self.function(number) == "input"
        self.keep(number, "input", float(high))

    def driven_high(self) -> set[int]:
        """Outputs that are not low, or not low all the time."""
        return {number for number in range(PINS) if self.function(number) == "output" and self.level(number) > 0.0}


class FiledPin(MockPWMPin):  # type: ignore[misc]  # gpiozero has no types
    """A pin that is, at first, as its last process left it."""

    def __init__(self, factory: FiledFactory, info: Any) -> None:
        super().__init__(factory, info)
        self._header, self._number = factory.header, int(info.name.removeprefix("GPIO"))
        function = self._header.function(self._number)
        if function is not None:
            self._function, self._state = function, self._header.level(self._number)
            self.clear_states()

    def _get_state(self) -> float:
        return self._header.level(self._number) if self._function == "input" else self._state

    def _set_function(self, value: str) -> None:
        super()._set_function(value)
        self._keep()

    def _change_state(self, value: float) -> bool:
        changed = bool(super()._change_state(value))
        self._keep()
        return changed

    def _keep(self) -> None:
        self._header.keep(self._number, self._function, float(self._state))


class FiledFactory(MockFactory):  # type: ignore[misc]
    """Named by GPIOZERO_PIN_FACTORY."""

    def __init__(self) -> None:
        super().__init__(pin_class=FiledPin)
        self.header = Header(Path(os.environ[WHERE]))


@contextmanager
def installed(folder: Path) -> Iterator[Header]:
    """What is started meanwhile drives these pins; one test at a time, for the vehicle's own lock is the machine's."""
    package = folder / "packages" / "filed_pins-1.dist-info"
    package.mkdir(parents=True)
    (package / "METADATA").write_text("Metadata-Version: 2.1\nName: filed-pins\nVersion: 1\n")
    (package / "entry_points.txt").write_text(f"[gpiozero_pin_factories]\n{FACTORY} = {__name__}:FiledFactory\n")
    path = os.pathsep.join(filter(None, [str(package.parent), os.environ.get("PYTHONPATH")]))
    lock = Path(tempfile.gettempdir()) / f"mavhelm-pins-{os.getuid()}.lock"
    with lock.open("w") as turn, pytest.MonkeyPatch.context() as patch:
        fcntl.flock(turn, fcntl.LOCK_EX)
        patch.setenv("PYTHONPATH", path)
        patch.setenv("GPIOZERO_PIN_FACTORY", FACTORY)
        patch.setenv(WHERE, str(folder / "pins"))
        yield Header(folder / "pins")
