"""The Zenoh session of a node: opened in a thread, tokens, subscriptions and services declared as it opens.

Zenoh calls back from threads of its own. What it calls here only puts what has arrived into the inbox, where the newest
message of each publisher replaces the one before, and wakes the event loop.
"""

from __future__ import annotations

import asyncio
import contextlib
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import msgspec
import zenoh

from groundstation.ros.rmw.attachment import Attachment, decode, gid_of
from groundstation.ros.rmw.names import EntityKind, RmwEndpoint, publisher_tokens
from groundstation.ros2.router import RosRouter
from link.fleet.router_session import RouterSession, direct

CLOSE_WITHIN = 2.0
MAX_WAITING = 64
"""Messages and requests that wait for the event loop."""
LONGEST_MESSAGE = 65536
"""Bytes; a Twist has 52."""


class Arrived(NamedTuple):
    """A message of a topic."""

    endpoint: RmwEndpoint
    data: bytes
    attachment: Attachment


class Request(msgspec.Struct, frozen=True):
    """A request to a service; `reply` takes the response, once."""

    endpoint: RmwEndpoint
    data: bytes
    attachment: Attachment
    reply: Callable[[bytes], None]


class WireEvents(msgspec.Struct, frozen=True):
    """Called in the event loop."""

    opened: Callable[[str], None]
    """A session is open, with this id: now declare()."""
    problem: Callable[[str], None]
    """Why there is no session; another attempt follows."""
    message: Callable[[Arrived], None]
    left: Callable[[str, bytes], None]
    """A publisher of this topic, with this id, has left."""
    request: Callable[[Request], None]


class RosWire:
    """One session, from start() to close()."""

    def __init__(self, router: RosRouter, events: WireEvents) -> None:
        self._events = events
        self._loop = asyncio.get_running_loop()
        self._held: list[Any] = []
        """Declarations live as long as they are held."""
        self._lock = threading.Lock()
        self._waiting: dict[object, Arrived | Request] = {}
        self._router = RouterSession("ros2", router.config, self._opened, self._failed)

    def start(self) -> None:
        """Connect, and try again until it succeeds."""
        self._router.start()

    def declare(self, domain: int, tokens: Sequence[str], endpoints: Sequence[RmwEndpoint]) -> None:
        """Show the tokens; take the messages and requests of the endpoints."""
        session, self._held = self._router.session, []
        if session is None:  # lost meanwhile
            return
        with self._router.quiet("declare"):
            for each in endpoints:
                if each.kind is EntityKind.SUBSCRIPTION:
                    self._subscribe(session, domain, each)
                elif each.kind is EntityKind.SERVICE:
                    take = self._query_taker(each)
                    self._held.append(session.declare_queryable(each.key, direct(take), complete=True))
            self._held += [session.liveliness().declare_token(token) for token in tokens]

    def publish(self, key: str, data: bytes, attachment: Attachment) -> None:
        """Send a message now or never."""
        session = self._router.session
        if session is not None:
            with self._router.quiet("publish"):
                session.put(key, data, attachment=attachment.encode())

    def close(self) -> None:
        """Leave, in a thread that is not waited for longer than CLOSE_WITHIN."""
        self._router.close(CLOSE_WITHIN)

    # ---- in threads ----

    def _opened(self, session: zenoh.Session) -> None:
        self._call(self._events.opened, str(session.info.zid()))

    def _failed(self, problem: str) -> None:
        self._call(self._events.problem, problem)

    def _subscribe(self, session: zenoh.Session, domain: int, endpoint: RmwEndpoint) -> None:
        def take(sample: zenoh.Sample) -> None:
            attachment = decode(bytes(sample.attachment or b""))
            data = bytes(sample.payload)
            if attachment is not None and len(data) <= LONGEST_MESSAGE:
                arrived = Arrived(endpoint, data, attachment)
                self._put((endpoint.number, attachment.gid), arrived)

        put = zenoh.SampleKind.PUT

        def note(sample: zenoh.Sample) -> None:
            if sample.kind != put:
                self._call(self._events.left, endpoint.name, gid_of(str(sample.key_expr)))

        tokens = publisher_tokens(domain, endpoint.name)
        self._held.append(session.declare_subscriber(endpoint.key, direct(take)))
        self._held.append(session.liveliness().declare_subscriber(tokens, direct(note)))

    def _query_taker(self, endpoint: RmwEndpoint) -> Callable[[zenoh.Query], None]:
        def take(query: zenoh.Query) -> None:
            attachment = decode(bytes(query.attachment or b""))
            data = bytes(query.payload or b"")
            if attachment is None or len(data) > LONGEST_MESSAGE:
                query.drop()  # type: ignore[no-untyped-call]
                return

            def reply(response: bytes) -> None:
                answer = Attachment(attachment.number, time.time_ns(), attachment.gid)
                with self._router.quiet("reply"), query:
                    query.reply(endpoint.key, response, attachment=answer.encode())

            if not self._put(object(), Request(endpoint, data, attachment, reply)):
                query.drop()  # type: ignore[no-untyped-call]

        return take

    def _put(self, key: object, item: Arrived | Request) -> bool:
        """Put what has arrived into the inbox; return False if it is full."""
        with self._lock:
            if len(self._waiting) >= MAX_WAITING and key not in self._waiting:
                return False
            is_first = not self._waiting
            self._waiting[key] = item
        if is_first:
            self._call(self._drain)
        return True

    def _call(self, function: Callable[..., None], *arguments: object) -> None:
        with contextlib.suppress(RuntimeError):  # the loop has ended
            self._loop.call_soon_threadsafe(function, *arguments)

    # ---- in the event loop ----

    def _drain(self) -> None:
        with self._lock:
            waiting, self._waiting = self._waiting, {}
        for item in waiting.values():
            if isinstance(item, Arrived):
                self._events.message(item)
            else:
                self._events.request(item)
