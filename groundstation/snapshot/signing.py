"""What is known of MAVLink signing between this station and the selected vehicle."""

from __future__ import annotations

from enum import Enum

import msgspec


class SigningState(Enum):
    """The values are the words of the status bar."""

    OFF = "off"
    """The vehicle does not sign, and takes what is not signed as far as it has told."""
    ON = "on"
    """Its frames are verified."""
    NO_KEY = "no key"
    """It signs with a key that is not here. Whether it obeys unsigned frames is not known."""
    REQUIRED = "required"
    """It has refused a request of ours, because it was not signed."""
    REJECTED = "rejected"
    """Only frames with a wrong key or none arrive from it, and they are refused."""
    REPLAYED = "replayed"
    """Only frames that have been accepted before arrive."""
    CLOCK = "clock"
    """Its frames are genuine, but its clock is more than a minute behind ours."""


class SigningView(msgspec.Struct, frozen=True):
    """State, and what follows from it."""

    state: SigningState
    text: str = ""
    """One line: what is known, and what to do."""
    refused: str = ""
    """Frames with the id of the vehicle that were refused in the last seconds, e.g. "3 wrong key"; empty if none."""
    clock: str = ""
    """How its signing clock differs from ours, where it is known and more than a second."""

    @property
    def alarm(self) -> str:
        """Text for the driver; empty if there is none, or if it is among the warnings of the vehicle."""
        calm = (SigningState.OFF, SigningState.ON, SigningState.NO_KEY)
        return "" if self.state in calm else f"signing {self.text}"

    @property
    def well(self) -> bool:
        """Nothing is to be done about it."""
        return self.state in (SigningState.OFF, SigningState.ON) and not self.refused
