"""How long a driver puts up with hardware that does not answer: a glitch passes, a dead bus does not."""

from __future__ import annotations

from vehicle.motors import MotorError

FAILURES_MAX = 3
"""In a row."""
SILENCE_MAX = 0.2
"""s from the first of them, or without a reply: ten control cycles. The rover then stops and disarms."""


class ErrorBudget:
    """Counts failures in a row."""

    def __init__(self) -> None:
        self._fails = 0
        self._since: float | None = None

    def reset(self) -> None:
        """An answer came: all is forgotten."""
        self._fails, self._since = 0, None

    def add_failure(self, reason: str, now: float) -> None:
        """One more failure. Raises MotorError at the third, or 0.2 s after the first."""
        self._fails += 1
        self.check_silence(reason, now)
        if self._fails >= FAILURES_MAX:
            raise MotorError(reason)

    def check_silence(self, reason: str, now: float) -> None:
        """There is no answer yet, which is no failure by itself. Raises MotorError 0.2 s after the first call."""
        self._since = now if self._since is None else self._since
        if now - self._since > SILENCE_MAX:
            raise MotorError(reason)
