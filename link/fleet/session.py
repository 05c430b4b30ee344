"""Session with a Zenoh router: opens it in a thread, declares what the keys say, publishes frames.

Zenoh calls back from threads of its own. What it calls here only puts frames into the inbox and wakes the event loop.
"""

from __future__ import annotations

import contextlib
import logging
import threading
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, Protocol

from link.fleet.config import FleetConfig, load_zenoh
from link.fleet.keys import FleetKeys
from link.fleet.probe import explain_failure
from link.transport.backoff import Backoff

if TYPE_CHECKING:
    import zenoh

log = logging.getLogger(__name__)

FIRST_RETRY, LONGEST_RETRY = 0.2, 1.0
"""s between attempts to open the first session; then Zenoh reconnects by itself."""
CLOSE_WITHIN = 3.0
"""s for the last frames and the farewell, which take 20 ms on an idle machine, also if the router stands still."""
MAX_KEYS = 4096
"""Keys that are kept parsed: those of 24 programs and all messages that each gets."""


class SessionEvents(Protocol):
    """What happens, told from threads of Zenoh."""

    def handle_frame(self, key: str, data: bytes) -> None:
        """Take what arrived under a key."""

    def handle_token(self, key: str, is_there: bool) -> None:
        """Take that a token is there, or has gone."""

    def handle_routers(self, routers: int) -> None:
        """Take the number of routers that are connected."""

    def handle_problem(self, problem: str) -> None:
        """Take why no session could be opened; another attempt follows."""


class FleetSession:
    """One session, from start() to close(). All methods are called from the event loop and do not block it."""

    def __init__(self, config: FleetConfig, keys: FleetKeys, events: SessionEvents) -> None:
        self._config, self._keys, self._events = config, keys, events
        self._zenoh = load_zenoh()
        self._session: zenoh.Session | None = None
        self._keys_in_use: dict[str, zenoh.KeyExpr] = {}
        self._declared: list[Any] = []
        """Subscribers live as long as they are held."""
        self._tokens: dict[str, zenoh.LivelinessToken] = {}
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._open, name="fleet", daemon=True)

    def start(self) -> None:
        """Connect, and try again until it succeeds."""
        self._thread.start()

    def publish(self, name: str, data: bytes) -> bool:
        """Publish one frame under a key; return False if there is no session. Without room it is dropped.

        Not by a declared publisher: of its frames a router with access rules passes only the first (eclipse-zenoh
        1.10.2). The quality of service is in the configuration.
        """
        session = self._session
        if session is None:
            return False
        with self._quiet("publish"):
            key = self._keys_in_use.get(name)
            if key is None:
                if len(self._keys_in_use) >= MAX_KEYS:
                    self._keys_in_use.clear()
                key = self._keys_in_use[name] = self._zenoh.KeyExpr(name)
            session.put(key, data)
        return True

    def show_token(self, key: str) -> None:
        """Tell others that this program is here, until close()."""
        if self._session is not None and key not in self._tokens:
            with self._quiet("declare a token"):
                self._tokens[key] = self._session.liveliness().declare_token(key)

    def close(self) -> None:
        """Say farewell in a thread that is not waited for longer than CLOSE_WITHIN."""
        self._closing.set()
        closer = threading.Thread(target=self._close, name="fleet end", daemon=True)
        closer.start()
        closer.join(CLOSE_WITHIN)

    # ---- in threads ----

    def _open(self) -> None:
        delays = Backoff(FIRST_RETRY, LONGEST_RETRY)
        while not self._closing.is_set():
            try:
                session = self._zenoh.open(self._config.zenoh)
            except self._zenoh.ZError as error:
                log.debug("no session: %s", error)
                self._events.handle_problem(explain_failure(self._config.routers[0], self._config.zenoh))
                self._closing.wait(delays.next_delay())
            else:
                with self._quiet("declare"):
                    self._declare(session)
                return

    def _declare(self, session: zenoh.Session) -> None:
        keys, events, live = self._keys, self._events, session.liveliness()
        put = self._zenoh.SampleKind.PUT

        def take(sample: zenoh.Sample) -> None:
            events.handle_frame(str(sample.key_expr), bytes(sample.payload))

        def note(sample: zenoh.Sample) -> None:
            events.handle_token(str(sample.key_expr), sample.kind == put)

        self._session = session
        self._declared = [
            session.info.declare_transport_events_listener(lambda _: self._count_routers(session), history=True),
            session.declare_subscriber(keys.frames, take),
            live.declare_subscriber(keys.others, note, history=True),
        ]
        if keys.me is None:
            self.show_token(keys.token(""))

    def _count_routers(self, session: zenoh.Session) -> None:
        self._events.handle_routers(len(session.info.routers_zid()))

    def _close(self) -> None:
        self._thread.join()
        session, self._session = self._session, None
        if session is not None:
            with self._quiet("close"):
                session.close()  # type: ignore[no-untyped-call]

    @contextlib.contextmanager
    def _quiet(self, what: str) -> Iterator[None]:
        """Log an error of Zenoh: the link is then down, and its events say so."""
        try:
            yield
        except self._zenoh.ZError as error:
            log.debug("could not %s: %s", what, error)
