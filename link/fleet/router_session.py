"""A Zenoh session with a router: opened in a thread, tried again until it succeeds, and closed without waiting long."""

from __future__ import annotations

import contextlib
import logging
import threading
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from link.fleet.config import load_zenoh
from link.fleet.probe import explain_failure
from link.transport.backoff import Backoff

if TYPE_CHECKING:
    import zenoh

log = logging.getLogger(__name__)

FIRST_RETRY, LONGEST_RETRY = 0.2, 1.0
"""s between attempts to open the first session; then Zenoh reconnects by itself."""


class RouterSession:
    """One session, from start() to close(). `opened` and `problem` are called from its thread.

    `problem` gets why there is no session; another attempt follows. `name` is that of the threads.
    """

    def __init__(
        self,
        name: str,
        locator: str,
        config: zenoh.Config,
        opened: Callable[[zenoh.Session], None],
        problem: Callable[[str], None],
    ) -> None:
        self._name, self._locator, self._config = name, locator, config
        self._opened, self._problem = opened, problem
        self._zenoh = load_zenoh()
        self.session: zenoh.Session | None = None
        """None before it is open, and once it is closed."""
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._open, name=name, daemon=True)

    def start(self) -> None:
        """Connect, and try again until it succeeds."""
        self._thread.start()

    def close(self, within: float) -> None:
        """Leave, in a thread that is not waited for longer than `within` s."""
        self._closing.set()
        closer = threading.Thread(target=self._close, name=f"{self._name} end", daemon=True)
        closer.start()
        closer.join(within)

    @contextlib.contextmanager
    def quiet(self, what: str) -> Iterator[None]:
        """Log an error of Zenoh: the router is away then, and whoever waits for something is told by its silence."""
        try:
            yield
        except self._zenoh.ZError as error:
            log.debug("could not %s: %s", what, error)

    def _open(self) -> None:
        delays = Backoff(FIRST_RETRY, LONGEST_RETRY)
        while not self._closing.is_set():
            try:
                session = self._zenoh.open(self._config)
            except self._zenoh.ZError as error:
                log.debug("no session: %s", error)
                self._problem(explain_failure(self._locator, self._config))
                self._closing.wait(delays.next_delay())
            else:
                self.session = session
                self._opened(session)
                return

    def _close(self) -> None:
        self._thread.join()
        session, self.session = self.session, None
        if session is not None:
            with self.quiet("close"):
                session.close()  # type: ignore[no-untyped-call]
