"""Base class of all intents."""

from __future__ import annotations

from typing import ClassVar

import msgspec


class Intent(msgspec.Struct, frozen=True, tag=True):
    """Base class of all intents."""

    is_input: ClassVar[bool] = True
    """The operator did something. False for what the screen sends on its own."""

    valid_when_late: ClassVar[bool] = False
    """Handled even when older than ipc.MAX_INTENT_AGE: the intent only ever stops, or reports a state."""

    open_to_all: ClassVar[bool] = False
    """Also carried out for a screen that does not drive: it stops, or reads what the vehicle has."""

    log_text: ClassVar[str] = ""
    """The line of the message log; `{0.field}` stands for a value of the intent. "": none."""

    def describe(self) -> str:
        """Return the line of the message log; "" for none."""
        return self.log_text.format(self)
