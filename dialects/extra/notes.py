"""What a definition file has to say, for the log."""

from __future__ import annotations

import msgspec

from dialects.enums import Severity


class Note(msgspec.Struct, frozen=True):
    """One line for the log."""

    text: str
    severity: Severity = Severity.INFO
