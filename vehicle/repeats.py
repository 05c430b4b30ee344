"""Filter for texts that are repeated within 3 s."""

from __future__ import annotations

REPEAT_AFTER = 3.0
"""s in which the same text is not sent again: as long as a command counts as repeated (PROGRESS_TIMEOUT in
link/services/command/request.py)."""


class RepeatFilter:
    """Remembers the newest `size` texts. The cost of a text does not depend on how many there were."""

    def __init__(self, size: int) -> None:
        self._size = size
        self._sent_at: dict[str, float] = {}
        """Text -> when it was sent, oldest first."""

    def __len__(self) -> int:
        return len(self._sent_at)

    def is_repeat(self, text: str, now: float) -> bool:
        """Return True for a text that came less than REPEAT_AFTER ago; remember any other."""
        if now - self._sent_at.get(text, float("-inf")) < REPEAT_AFTER:
            return True
        self._sent_at.pop(text, None)
        self._sent_at[text] = now
        if len(self._sent_at) > self._size:
            del self._sent_at[next(iter(self._sent_at))]
        return False
