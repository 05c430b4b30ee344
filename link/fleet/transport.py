"""`zenoh`: one link to all programs that meet at a router. Each vehicle, or each ground station, is a connection.

A vehicle's address is its name, a ground station's the name of its operator and a number of its run, as "alice/3f2a".
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import secrets
from collections.abc import Callable, Hashable
from functools import partial

from link.endpoint import Endpoint, Side
from link.fleet.config import VEHICLE_ROLE, FleetConfig, load_config
from link.fleet.inbox import Inbox
from link.fleet.keys import FleetKeys, read_frame
from link.fleet.presence import Presence
from link.fleet.roles import needed_role
from link.fleet.session import FleetSession
from link.protocol.frame import Frame, read_header
from link.protocol.link_events import CONNECTING
from link.signing.role import Role
from link.transport.transport import DisconnectCallback, LinkError, Outlet, ReceiveCallback

log = logging.getLogger(__name__)

TICK = 0.5
"""s between two looks at who has gone."""
SAY_AGAIN = 10.0
"""s between two log lines of the same kind."""


class FleetTransport:
    """One endpoint of a fleet."""

    def __init__(self, endpoint: Endpoint, config: FleetConfig, *, is_vehicle: bool) -> None:
        self.endpoint = endpoint
        self.problem: str | None = f"{endpoint.text}: {CONNECTING}"
        self.stream = True
        """Programs connect and disconnect, though no frame is ever split."""
        self.fixed_address: Hashable | None = None
        self.capacity: float | None = None
        self.refused = 0
        """Frames dropped because their key names another message, role or sender."""
        self._refused_key = ""
        """The newest key of such a frame that was not reported yet."""
        self._role, self._name = config.operator_role, config.name
        me = None if is_vehicle else f"{config.name}/{secrets.token_hex(4)}"
        self._keys = FleetKeys(endpoint.fleet, endpoint.vehicle, me)
        self._session = FleetSession(config, self._keys, self)
        self._inbox = Inbox()
        self._presence = Presence()
        self._unsent = 0
        self._loop: asyncio.AbstractEventLoop | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._said: dict[str, float] = {}
        self._on_receive: ReceiveCallback = lambda _: None
        self._on_disconnect: DisconnectCallback = lambda _: None

    @property
    def dropped(self) -> int:
        """Frames that were not sent or not handed over: no room, too old, overtaken, not allowed, under a wrong key."""
        return self._unsent + self.refused + self._inbox.dropped

    def start(
        self, loop: asyncio.AbstractEventLoop, on_receive: ReceiveCallback, on_disconnect: DisconnectCallback
    ) -> None:
        """Start to connect."""
        self._loop, self._on_receive, self._on_disconnect = loop, on_receive, on_disconnect
        self._session.start()
        self._tick(loop)

    def send(self, data: bytes, address: Hashable) -> None:
        """Publish the frames in `data` for one program."""
        while data:
            header = read_header(data)
            size = len(data) if header is None else header.size
            self._send_frame(data[:size], str(address))
            data = data[size:]

    def refusal(self, data: bytes) -> str | None:
        """Return which role this program lacks to send a frame; None if it may, or its role is not known."""
        frame = read_frame(data) if self._role not in (None, Role.SET_UP) else None
        return None if frame is None else self._role_missing(frame)

    def outlet(self, address: Hashable) -> Outlet | None:
        """Return None: a session cannot be handed to another process."""
        return None

    def close(self) -> None:
        """End the session."""
        if self._timer:
            self._timer.cancel()
        self._loop = None
        self._session.close()

    def _send_frame(self, data: bytes, address: str) -> None:
        frame = read_frame(data)
        if frame is None:
            self._unsent += 1
            return
        if why := self._role_missing(frame):
            self._say(f"a message was not sent: {why}", f"{frame[0]}")
            self._unsent += 1
        elif not self._session.publish(self._keys.place(frame, address), data):
            self._unsent += 1

    def _role_missing(self, frame: Frame) -> str | None:
        if not self._keys.me or self._role is None:
            return None
        needed = needed_role(frame)
        if needed <= self._role:
            return None
        return f"the certificate of {self._name} may {self._role.word} only; ask for the role {needed.word}"

    # ---- from threads of Zenoh ----

    def handle_frame(self, key: str, data: bytes) -> None:
        """Put a frame into the inbox if its key fits, and wake the loop."""
        loop = self._loop
        found = self._keys.read(key, data)
        if loop is None:
            return
        if found is None:
            self.refused += 1
            self._refused_key = key  # the next tick says so: a flood must not keep the loop busy
        elif self._inbox.put(found[0], data, loop.time()):
            self._call(loop, self._deliver)

    def handle_token(self, key: str, is_there: bool) -> None:
        """Tell the loop who came or has gone."""
        address = self._keys.read_token(key)
        if self._loop is not None and address is not None:
            self._call(self._loop, partial(self._note_token, address, is_there))

    def handle_routers(self, routers: int) -> None:
        """Tell the loop whether a router is connected."""
        problem = None if routers else "connection to the router lost; trying again"
        if self._loop is not None:
            self._call(self._loop, partial(self._note_problem, problem))

    def handle_problem(self, problem: str) -> None:
        """Tell the loop why no router is connected."""
        if self._loop is not None:
            self._call(self._loop, partial(self._note_problem, f"{problem}; trying again"))

    @staticmethod
    def _call(loop: asyncio.AbstractEventLoop, what: Callable[[], None]) -> None:
        with contextlib.suppress(RuntimeError):  # the loop has ended
            loop.call_soon_threadsafe(what)

    # ---- in the loop ----

    def _deliver(self) -> None:
        if self._loop is None:
            return
        taken, more = self._inbox.take(self._loop.time())
        if more:
            self._loop.call_soon(self._deliver)
        if mine := [(data, address) for data, address in taken if self._is_owner(data, address)]:
            self._on_receive(mine)

    def _is_owner(self, data: bytes, address: str) -> bool:
        """Return whether a frame's system id is that of its vehicle; two vehicles with one id would look like one."""
        header = read_header(data)
        if header is None or not self._keys.me:
            return header is not None
        owner = self._presence.owner(header.system, address)
        if owner != address:
            self.refused += 1
            self._say(f"{address} sends with system id {header.system} of {owner}: give it another MAV_SYSID", address)
        return owner == address

    def _note_token(self, address: str, is_there: bool) -> None:
        if self._loop is None:
            return
        if not is_there:
            self._presence.remove(address, self._loop.time())
            return
        if self._keys.me:
            self._session.show_token(self._keys.token(address))
        if self._presence.add(address):
            log.debug("%s: %s is connected", self.endpoint.text, address)
            self._on_receive([(b"", address)])

    def _note_problem(self, problem: str | None) -> None:
        self.problem = None if problem is None else f"{self.endpoint.text}: {problem}"

    def _tick(self, loop: asyncio.AbstractEventLoop) -> None:
        for address in self._presence.expire(loop.time()):
            log.debug("%s: %s has disconnected", self.endpoint.text, address)
            self._inbox.forget(address)
            self._on_disconnect(address)
        if self._refused_key:
            self._say("frames were dropped: they are not what their key names", self._refused_key)
            self._refused_key = ""
        self._timer = loop.call_later(TICK, self._tick, loop)

    def _say(self, what: str, about: str) -> None:
        """Log a warning, not more than once in SAY_AGAIN."""
        now = 0.0 if self._loop is None else self._loop.time()
        if now - self._said.get(what, -SAY_AGAIN) >= SAY_AGAIN:
            self._said = {text: at for text, at in self._said.items() if now - at < SAY_AGAIN} | {what: now}
            log.warning("%s: %s (%s)", self.endpoint.text, what, about)


def open_fleet(endpoint: Endpoint) -> FleetTransport:
    """Read the configuration; start() connects. Raises LinkError."""
    config = load_config(endpoint)
    side, role = endpoint.side, config.role
    named = bool(endpoint.vehicle) if role is None else role == VEHICLE_ROLE
    is_vehicle = named if side is None else side is Side.VEHICLE
    if is_vehicle and not endpoint.vehicle:
        raise LinkError(f"{endpoint.text}: name this vehicle, for example {endpoint.text}/rover1")
    return FleetTransport(endpoint, config, is_vehicle=is_vehicle)
