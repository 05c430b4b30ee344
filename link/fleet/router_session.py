"""A Zenoh session with a router: opened in a thread as soon as one answers, made anew when it is lost, closed in time.

Zenoh would connect again by itself, but late (link/fleet/probe.py says why), and to the router that has just failed.
"""

from __future__ import annotations

import contextlib
import ctypes
import json
import logging
import random
import threading
import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from link.fleet.config import OPEN_TIMEOUT, load_zenoh
from link.fleet.explain import explain_failure
from link.fleet.probe import RouterProbe
from link.transport.backoff import Backoff

if TYPE_CHECKING:
    import zenoh

log = logging.getLogger(__name__)

FIRST_RETRY, LONGEST_RETRY = 0.2, 1.0
"""s between attempts at a router that answers and refuses; each takes half of it to all of it, at random."""
LOST = "connection to the router lost"


def direct(callback: Callable[[Any], object]) -> Any:
    """Return what a session calls `callback` by, in its own threads. It must be short, and wait for nothing.

    Otherwise the package runs a thread of Python for each callback, which aborts the program ("FATAL: exception not
    rethrown") if it is not through when the program ends.
    """

    def call(event: Any) -> None:
        _keep_thread_state()
        callback(event)

    return load_zenoh().handlers.Callback(call, indirect=False)


_of_thread = threading.local()


def _keep_thread_state() -> None:
    """Keep Python's state of this thread, which is not one of Python's.

    It is made for each callback otherwise, and freed after it, while the event loop that the callback has woken waits
    for the interpreter: 0.1 ms for each frame of a demand.
    """
    if not hasattr(_of_thread, "kept"):
        ctypes.pythonapi.PyGILState_Ensure()  # the state stays as long as one of these is not released
        _of_thread.kept = True


class RouterSession:
    """One session at a time, from start() to close(). `opened` and `problem` are called from its thread.

    `opened` gets each new session, and declares everything. `problem` gets why there is none; it is tried again until
    there is. `name` is that of the threads; `config` names the routers.
    """

    def __init__(
        self,
        name: str,
        config: zenoh.Config,
        opened: Callable[[zenoh.Session], None],
        problem: Callable[[str], None],
    ) -> None:
        self._name, self._config = name, config
        self._opened, self._problem = opened, problem
        self._zenoh = load_zenoh()
        self.session: zenoh.Session | None = None
        """None before it is open, while it is lost, and once it is closed."""
        self._probe = RouterProbe(json.loads(config.get_json("connect/endpoints")))
        self._closing = threading.Event()
        self._wake = threading.Event()
        """The session is lost, or shall be closed."""
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._ending: threading.Thread | None = None
        """Closes the session that was lost last."""

    def start(self) -> None:
        """Connect, and try again until it succeeds."""
        self._thread.start()

    def close(self, within: float) -> None:
        """Leave, in a thread that is not waited for longer than `within` s."""
        self._closing.set()
        self._wake.set()
        closer = threading.Thread(target=self._close, name=f"{self._name} end", daemon=True)
        closer.start()
        closer.join(within)

    @contextlib.contextmanager
    def quiet(self, what: str) -> Iterator[None]:
        """Log an error of Zenoh, as note_error()."""
        try:
            yield
        except self._zenoh.ZError as error:
            self.note_error(what, error)

    @staticmethod
    def note_error(what: str, error: Exception) -> None:
        """Log an error of Zenoh: the router is away then, and whoever waits for something is told by its silence."""
        log.debug("could not %s: %s", what, error)

    def _run(self) -> None:
        used, told = None, self._problem
        while opened := self._open(used, told):
            self.session, used = opened
            self._hold(self.session)
            if self._closing.is_set():
                return
            lost, self.session = self.session, None
            self._ending = threading.Thread(target=self._end, args=(lost,), name=f"{self._name} lost", daemon=True)
            self._ending.start()
            self._problem(LOST)
            told = self._tell_since_lost

    def _open(self, tried: str | None, tell: Callable[[str], None]) -> tuple[zenoh.Session, str] | None:
        """Return a new session and the locator of its router; None if it shall close."""
        delays = Backoff(FIRST_RETRY, LONGEST_RETRY)
        while locator := self._probe.find(tried, self._closing, tell):
            tried, begun = locator, time.monotonic()
            self._config.insert_json5("connect/endpoints", json.dumps([locator]))
            try:
                return self._zenoh.open(self._config), locator
            except self._zenoh.ZError as error:
                log.debug("no session: %s", error)
            if time.monotonic() - begun < OPEN_TIMEOUT / 1000:
                tell(explain_failure(locator, self._config))
                self._closing.wait(delays.next_delay() * random.uniform(0.5, 1.0))
            else:  # it may come back at any moment
                tell(f"the router at {locator} does not answer")
        return None

    def _hold(self, session: zenoh.Session) -> None:
        """Return when the session is lost, or shall be closed. Its own attempts to connect again are not waited for."""
        delete = self._zenoh.SampleKind.DELETE

        def note(event: zenoh.TransportEvent) -> None:
            if event.kind == delete:
                self._wake.set()

        self._wake.clear()
        if self._closing.is_set():
            return
        with self.quiet("watch the router"):
            listener = session.info.declare_transport_events_listener(direct(note))
            if session.info.transports():
                self._opened(session)
                self._wake.wait()
            del listener

    def _tell_since_lost(self, problem: str) -> None:
        self._problem(f"{LOST}; {problem}")

    def _close(self) -> None:
        self._thread.join()
        if self._ending is not None:
            self._ending.join()
        session, self.session = self.session, None
        if session is not None:
            self._end(session)

    def _end(self, session: zenoh.Session) -> None:
        with self.quiet("close"):
            session.close()  # type: ignore[no-untyped-call]
