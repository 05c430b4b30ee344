"""ErrorBudget: how long a driver tolerates hardware that does not respond; a glitch passes, a dead bus does not."""

from __future__ import annotations

from vehicle.motors import MotorError

FAILURES_MAX = 3
"""Number of consecutive failures."""
SILENCE_MAX = 0.2
"""s from the first failure, or without a reply: ten control cycles. The rover then stops and disarms."""


class ErrorBudget:
    """Counts consecutive failures."""

    def __init__(self) -> None:
        self._fails = 0
        self._since: float | None = None

    def reset(self) -> None:
        """Start anew, after a response."""
        self._fails, self._since = 0, None

    def add_failure(self, reason: str, now: float) -> None:
        """Count a failure. Raises MotorError at FAILURES_MAX, or SILENCE_MAX after the first."""
        self._fails += 1
        self.check_silence(reason, now)
        if self._fails >= FAILURES_MAX:
            raise MotorError(reason)

    def check_silence(self, reason: str, now: float) -> None:
        """Note a missing reply, which alone is not a failure. Raises MotorError SILENCE_MAX after the first call."""
        self._since = now if self._since is None else self._since
        if now - self._since > SILENCE_MAX:
            raise MotorError(reason)
