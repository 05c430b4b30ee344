"""Is there a person behind the demand, and is it new? ROVER_OPERATOR_PRESENCE, for ground stations that send it."""

from __future__ import annotations

import math

from dialects.enums import OperatorFlag
from dialects.messages import UINT16_MAX, RoverOperatorPresence, boot_ms

_WRAP = 2**32


class OperatorPresence:
    """The newest word on the operator."""

    def __init__(self) -> None:
        self.known = False
        """This driver sends ROVER_OPERATOR_PRESENCE."""
        self.echo_age = 0.0
        """s since what the driver has seen of us was sent: no demand with it is older. 0 where it saw nothing."""
        self._session: int | None = None
        self._input_at = -math.inf
        self._input_lost = False

    def handle(self, message: RoverOperatorPresence, since_boot: float, now: float) -> bool:
        """Take the newest; True where a new driving session began."""
        new_session = self.known and message.session_id != self._session
        self.known = True
        self._session = message.session_id
        self.echo_age = _echo_age(message.echo_time_boot_ms, since_boot)
        age = message.last_input_age_ms
        self._input_at = -math.inf if age == UINT16_MAX else now - age / 1000
        self._input_lost = bool(message.flags & OperatorFlag.INPUT_LOST)
        return new_session

    def is_lost(self, timeout: float, now: float) -> bool:
        """No key or stick event for `timeout` s, or the input device is gone."""
        return self.known and (self._input_lost or now - self._input_at > timeout)


def _echo_age(echo: int, since_boot: float) -> float:
    """0 means "none seen yet". An echo from the future is one of a former boot and comes out as weeks old."""
    return ((boot_ms(since_boot) - echo) % _WRAP) / 1000 if echo else 0.0
