"""How long a driver puts up with hardware that does not answer: a glitch passes, a dead bus does not."""

from __future__ import annotations

from vehicle.motors import MotorError

FAILS = 3
"""In a row."""
SILENCE = 0.2
"""s from the first of them, or without a reply: ten control cycles. The rover then stops and disarms."""


class Patience:
    """Counts failures in a row."""

    def __init__(self) -> None:
        self._fails = 0
        self._since: float | None = None

    def worked(self) -> None:
        """An answer came: all is forgotten."""
        self._fails, self._since = 0, None

    def failed(self, reason: str, now: float) -> None:
        """One more failure. Raises MotorError at the third, or 0.2 s after the first."""
        self._fails += 1
        self.waiting(reason, now)
        if self._fails >= FAILS:
            raise MotorError(reason)

    def waiting(self, reason: str, now: float) -> None:
        """There is no answer yet, which is no failure by itself. Raises MotorError 0.2 s after the first call."""
        self._since = now if self._since is None else self._since
        if now - self._since > SILENCE:
            raise MotorError(reason)
