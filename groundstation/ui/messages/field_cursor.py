"""FieldCursor: the chosen field of the chosen message. Knows no widget."""

from __future__ import annotations

from collections.abc import Sequence

from groundstation.views.messages import MessageField, MessageView

CLOCKS = ("time_boot_ms", "time_usec", "time_unix_usec")
"""Fields that are chosen last: a plot of a clock shows nothing."""


class FieldCursor:
    """Chooses the first field that can be drawn, until the user chooses another one."""

    def __init__(self) -> None:
        self.field = ""
        self.index = 0
        """Item of the field, where it is an array."""
        self._message = ""

    def follow(self, view: MessageView) -> None:
        """Keep the field of this message, or choose one of another message."""
        names = [field.name for field in view.fields]
        if view.name == self._message and self.field in names:
            return
        self._message, self.index = view.name, 0
        self.field = _first(view.fields)

    def move(self, view: MessageView, rows: int) -> None:
        """Choose the field so many rows below."""
        names = [field.name for field in view.fields]
        if names:
            at = names.index(self.field) if self.field in names else 0
            self.field, self.index = names[max(0, min(at + rows, len(names) - 1))], 0

    def turn(self, items: int) -> None:
        """Choose another item of an array; the station keeps it within the array."""
        self.index = max(0, min(self.index + items, 255))


def _first(fields: Sequence[MessageField]) -> str:
    drawn = [field.name for field in fields if field.spark]
    return next((name for name in drawn if name not in CLOCKS), fields[0].name if fields else "")
