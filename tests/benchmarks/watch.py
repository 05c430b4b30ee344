"""One thread that waits on descriptors: what arrives is read at once, and time passes in poll() only."""

from __future__ import annotations

import selectors
import time
from collections.abc import Callable


class Watch:
    """Descriptors and the reader of each; a reader returns False when its descriptor has ended."""

    def __init__(self) -> None:
        self._selector = selectors.DefaultSelector()

    def add(self, descriptor: int, reader: Callable[[], bool]) -> None:
        """Call `reader` whenever there is something to read."""
        self._selector.register(descriptor, selectors.EVENT_READ, reader)

    def remove(self, descriptor: int) -> None:
        """Forget a descriptor that may have ended already."""
        if descriptor in self._selector.get_map():
            self._selector.unregister(descriptor)

    def until(self, condition: Callable[[], bool], within: float) -> bool:
        """Read until `condition`; return False if it is still false after `within` s."""
        deadline = time.monotonic() + within
        while not condition():
            left = deadline - time.monotonic()
            if left <= 0:
                return False
            self._read(left)
        return True

    def pause(self, seconds: float) -> None:
        """Let time pass, and read meanwhile."""
        self.until(lambda: False, seconds)

    def close(self) -> None:
        """Forget all of them."""
        self._selector.close()

    def _read(self, timeout: float) -> None:
        for key, _ in self._selector.select(timeout):
            if not key.data():
                self.remove(key.fd)
