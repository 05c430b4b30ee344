"""The modes that a vehicle lists itself by AVAILABLE_MODES: their numbers, and the names of those no table knows."""

from __future__ import annotations

from dialects import messages as m
from dialects.mode_tables import STANDARD_MODES
from dialects.printable import printable

MAX_MODES = 128
"""AVAILABLE_MODES of one vehicle; ArduPilot has 30, PX4 up to 40 with modes of other programs."""


def listed_name(message: m.AvailableModes) -> str:
    """Return the name of a mode as the vehicle lists it, else by its MAV_STANDARD_MODE; "" if it has neither."""
    name = printable(message._mode_name_raw.split(b"\0", 1)[0].decode("utf-8", "replace"))
    return name or STANDARD_MODES.get(message.standard_mode, "")


class ModeList:
    """What AVAILABLE_MODES has told so far."""

    def __init__(self) -> None:
        self._names: dict[int, str] = {}
        self._sequence: int | None = None

    def __contains__(self, custom_mode: int) -> bool:
        """Return whether the vehicle lists this custom_mode."""
        return custom_mode in self._names

    def add(self, message: m.AvailableModes) -> None:
        """Handle one mode of the list."""
        if len(self._names) < MAX_MODES:
            self._names[message.custom_mode] = listed_name(message)

    def note_change(self, message: m.AvailableModesMonitor) -> None:
        """Forget the list if the vehicle says that it has changed."""
        if self._sequence not in (None, message.seq):
            self._names.clear()
        self._sequence = message.seq

    def name_of(self, custom_mode: int) -> str:
        """Return the vehicle's own name for a custom_mode; "mode 99" for one that has none."""
        return self._names.get(custom_mode) or f"mode {custom_mode}"
