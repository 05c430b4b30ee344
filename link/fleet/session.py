"""Session with a Zenoh router: opens it in a thread, declares what the keys say, publishes frames.

Zenoh calls back from threads of its own. What it calls here only puts frames into the inbox and wakes the event loop.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from link.fleet.config import FleetConfig, load_zenoh
from link.fleet.keys import FleetKeys
from link.fleet.router_session import RouterSession, direct

if TYPE_CHECKING:
    import zenoh

CLOSE_WITHIN = 3.0
"""s for the last frames and the farewell, which take 20 ms on an idle machine, also if the router stands still."""
MAX_FRAME = 280
"""Bytes of the longest MAVLink frame: 255 of payload, 12 of MAVLink 2 and a signature of 13."""
MAX_KEY = 256
"""Characters of a key that is looked at; ours have up to 160."""
MAX_KEYS = 4096
"""Keys that are kept parsed: those of 24 programs and all messages that each gets."""


class SessionEvents(Protocol):
    """What happens, told from threads of Zenoh."""

    def handle_frame(self, key: str, data: bytes) -> None:
        """Handle a sample that arrived under a key."""

    def handle_oversized(self) -> None:
        """Note that something arrived that is no frame, because of its length or that of its key. It was not copied."""

    def handle_token(self, key: str, is_there: bool) -> None:
        """Note that a token is there, or has gone."""

    def handle_connected(self) -> None:
        """Note that there is a session; who is there follows."""

    def handle_problem(self, problem: str) -> None:
        """Note why there is no session; another attempt follows. Tokens of the one before count no more."""


class FleetSession:
    """One session, from start() to close(). All methods are called from the event loop and do not block it."""

    def __init__(self, config: FleetConfig, keys: FleetKeys, events: SessionEvents) -> None:
        self._config, self._keys, self._events = config, keys, events
        self._zenoh = load_zenoh()
        self._keys_in_use: dict[str, zenoh.KeyExpr] = {}
        self._declared: list[Any] = []
        """Subscribers live as long as they are held."""
        self._tokens: dict[str, tuple[zenoh.Session, zenoh.LivelinessToken]] = {}
        """Key -> the session in which the token was shown, and the token."""
        self._router = RouterSession("fleet", config.zenoh, self._opened, events.handle_problem)

    def start(self) -> None:
        """Connect, and try again until it succeeds."""
        self._router.start()

    def publish(self, name: str, data: bytes) -> bool:
        """Publish one frame under a key; return False if there is no session. Without room it is dropped.

        Not by a declared publisher: of its frames a router with access rules passes only the first (eclipse-zenoh
        1.10.2). The quality of service is in the configuration.
        """
        session = self._router.session
        if session is None:
            return False
        try:
            session.put(self._keys_in_use.get(name) or self._make_key(name), data)
        except self._zenoh.ZError as error:
            self._router.note_error("publish", error)
        return True

    def _make_key(self, name: str) -> zenoh.KeyExpr:
        if len(self._keys_in_use) >= MAX_KEYS:
            self._keys_in_use.clear()
        self._keys_in_use[name] = self._zenoh.KeyExpr(name)
        return self._keys_in_use[name]

    def show_token(self, key: str) -> None:
        """Tell others that this program is here, until the session ends."""
        session, shown = self._router.session, self._tokens.get(key)
        if session is not None and (shown is None or shown[0] is not session):
            with self._router.quiet("declare a token"):
                self._tokens[key] = session, session.liveliness().declare_token(key)

    def hide_token(self, key: str) -> None:
        """Withdraw the token that show_token() has announced."""
        session, token = self._tokens.pop(key, (None, None))
        if token is not None and session is self._router.session:
            with self._router.quiet("undeclare a token"):
                token.undeclare()  # type: ignore[no-untyped-call]

    def close(self) -> None:
        """Say farewell in a thread that is not waited for longer than CLOSE_WITHIN."""
        self._router.close(CLOSE_WITHIN)

    # ---- in threads ----

    def _opened(self, session: zenoh.Session) -> None:
        with self._router.quiet("declare"):
            self._declare(session)

    def _declare(self, session: zenoh.Session) -> None:
        keys, events, live = self._keys, self._events, session.liveliness()
        put = self._zenoh.SampleKind.PUT

        def take(sample: zenoh.Sample) -> None:
            key, payload = str(sample.key_expr), sample.payload
            if len(payload) > MAX_FRAME or len(key) > MAX_KEY:
                events.handle_oversized()
            else:
                events.handle_frame(key, bytes(payload))

        def note(sample: zenoh.Sample) -> None:
            key = str(sample.key_expr)
            if len(key) <= MAX_KEY and self._router.session is session:  # one that is lost says late who has gone
                events.handle_token(key, sample.kind == put)

        events.handle_connected()
        self._declared = [
            session.declare_subscriber(keys.frames, direct(take)),
            live.declare_subscriber(keys.others, direct(note), history=True),
        ]
        if keys.me is None:
            self.show_token(keys.token(""))
