"""The intent of the command line of the screens."""

from __future__ import annotations

from groundstation.intents.base import Intent


class RunLine(Intent, frozen=True):
    """Run a verb of `mavhelm` in the station, for the vehicle that the operator saw."""

    request: int
    """By which LineView reports how it stands; see ui/display/request_numbers.py."""
    text: str
    """E.g. "mode HOLD"."""
    system: int = 0
    """System id of the vehicle; 0: there was none."""
    confirmed: bool = False
    """The operator has answered the question that it asks first."""
