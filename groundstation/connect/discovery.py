"""Discovery: what announces itself on the local network, asked for in a thread while somebody looks."""

from __future__ import annotations

from groundstation.views.connect import HeardRow
from link.discovery.mdns import Browser
from link.runtime.worker import Worker

CLOSE_TIMEOUT = 1.0
"""s that the end of the program waits for the library."""


class Discovery:
    """Searches while `look` is called; `pause` ends it."""

    def __init__(self) -> None:
        self._browser = Browser()
        self._worker = Worker("discovery", 0)  # one job for each change between searching and not
        self._searching = False

    def look(self) -> None:
        """Search, from now on. The library is loaded first, which takes 0.1 s."""
        if not self._searching:
            self._searching = True
            self._worker.submit(self._browser.open)

    def pause(self) -> None:
        """Stop searching, and forget what was found."""
        if self._searching:
            self._searching = False
            self._worker.submit(self._browser.close)

    def close(self) -> None:
        """Stop searching, for good."""
        self.pause()
        self._worker.close(CLOSE_TIMEOUT)

    @property
    def problem(self) -> str:
        """Why nothing is found, one line."""
        return self._browser.problem if self._searching else ""

    def found(self, opened: frozenset[str]) -> tuple[HeardRow, ...]:
        """Return what is announced; `opened` are the endpoints of our links, which are listed already."""
        return tuple(
            HeardRow(
                endpoint=each.endpoint,
                system=each.system,
                name=each.name,
                mode="",
                armed=False,
                silence=0.0,
                announced=True,
            )
            for each in self._browser.services
            if each.endpoint not in opened
        )
