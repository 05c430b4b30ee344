"""ROVER_OPERATOR_PRESENCE: whether an operator is active, and how old the demand is."""

from __future__ import annotations

import math

from dialects.enums import OperatorFlag
from dialects.messages import UINT16_MAX, RoverOperatorPresence
from vehicle.drive.operator_session import echo_age


class OperatorPresence:
    """The newest ROVER_OPERATOR_PRESENCE of the ground station in control."""

    def __init__(self, *, echoes: bool = False) -> None:
        """`echoes`: it has echoed the vehicle's time before, so that nothing is fresh until it does again."""
        self.known = False
        """The ground station sends ROVER_OPERATOR_PRESENCE."""
        self._has_echoed = echoes
        self._echoed_at = -math.inf if echoes else math.inf
        """Time of the newest vehicle data that the operator has seen; no demand with it is older.

        Infinite before the first echo; -infinite for a ground station that sends none any more."""
        self._session: int | None = None
        self._input_at = -math.inf
        self._input_lost = False

    def handle(self, message: RoverOperatorPresence, since_boot: float, now: float) -> bool:
        """Handle a message; return True if a new driving session began."""
        new_session = self.known and message.session_id != self._session
        self.known = True
        self._session = message.session_id
        self._has_echoed |= message.echo_time_boot_ms != 0
        self._echoed_at = now - self._measure_echo(message.echo_time_boot_ms, since_boot)
        age = message.last_input_age_ms
        self._input_at = -math.inf if age == UINT16_MAX else now - age / 1000
        self._input_lost = bool(message.flags & OperatorFlag.INPUT_LOST)
        return new_session

    def echo_age(self, now: float) -> float:
        """Return the s since the newest vehicle data that the operator has seen; -infinite before the first echo."""
        return now - self._echoed_at

    def is_lost(self, timeout: float, now: float) -> bool:
        """Return True if there was no key or stick event for `timeout` s, or the input device is lost."""
        return self.known and (self._input_lost or now - self._input_at > timeout)

    def _measure_echo(self, echo: int, since_boot: float) -> float:
        """Return the age of the echoed boot time in s; -infinite if there was none yet.

        An echo of 0 after others is old, else a program that stopped echoing would switch the check off.
        """
        return echo_age(echo, since_boot) if self._has_echoed else -math.inf
