"""`zenoh`: one link to all programs that meet at a router. Each vehicle, or each ground station, is a connection.

A vehicle's address is its name, a ground station's the name of its operator and a number of its run, as "alice/3f2a".
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import math
import secrets
import time
from collections.abc import Callable, Hashable
from functools import partial

from dialects.messages import Heartbeat
from link.endpoint import Endpoint, Side
from link.fleet.arrivals import PACE, Arrivals
from link.fleet.brevity import BriefTelemetry
from link.fleet.config import VEHICLE_ROLE, FleetConfig, load_config
from link.fleet.inbox import BATCH, Inbox
from link.fleet.keys import MAX_KEYS, FleetKeys, FleetPlace, KeyReader, new_framer, read_frame
from link.fleet.presence import Presence
from link.fleet.rights.circumstances import Circumstances
from link.fleet.roles import WatchCondition, depends_on_content, needed_role, target_of, watch_condition
from link.fleet.session import FleetSession
from link.fleet.validity import warning_of
from link.protocol.frame import Frame, Header, read_header
from link.protocol.link_events import CONNECTING
from link.signing.role import SigningRole
from link.transport.priority_queue import STALE
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
        self._oversized = 0
        """What was too long for a frame, or had too long a key."""
        self._oversized_said = 0
        self._refused_key = ""
        """The newest key of such a frame that was not reported yet."""
        self._role, self._name = config.operator_role, config.name
        self._certificate = config.certificate
        me = None if is_vehicle else f"{config.name}/{secrets.token_hex(4)}"
        self._keys = FleetKeys(endpoint.fleet, endpoint.vehicle, me)
        self._session = FleetSession(config, self._keys, self)
        self._reader = KeyReader(self._keys)
        self._framer = new_framer()
        self._newest: tuple[bytes, Frame | None] = (b"", None)
        """What was asked about or sent last, and the frame that it is: most frames are both."""
        self._ways: dict[tuple[str, int], str] = {}
        """Address and message -> the key of its frames, unless that depends on their content."""
        self._arrivals = Arrivals()
        self._inbox = Inbox()
        self._delivered_at = -math.inf
        """When frames were delivered last."""
        self._delivery: asyncio.TimerHandle | None = None
        self._presence = Presence()
        self._brief = BriefTelemetry()
        self._circumstances = Circumstances()
        self._interesting: frozenset[int] | None = None
        self._unsent = 0
        self._loop: asyncio.AbstractEventLoop | None = None
        self._timer: asyncio.TimerHandle | None = None
        self._said: dict[str, float] = {}
        self._on_receive: ReceiveCallback = lambda _: None
        self._on_disconnect: DisconnectCallback = lambda _: None

    @property
    def dropped(self) -> int:
        """Frames that were not sent or not handed over: no room, too old, overtaken, not allowed, under a wrong key."""
        return self._unsent + self.refused + self._oversized + self._arrivals.dropped + self._inbox.dropped

    def start(
        self, loop: asyncio.AbstractEventLoop, on_receive: ReceiveCallback, on_disconnect: DisconnectCallback
    ) -> None:
        """Start to connect."""
        self._loop, self._on_receive, self._on_disconnect = loop, on_receive, on_disconnect
        self._session.start()
        remedy = f"`mavhelm bridge fleet renew {self._name}` makes a new file"
        if warning := warning_of(self._name, self._certificate, time.time(), remedy):
            log.warning("%s: %s", self.endpoint.text, warning)
        self._tick(loop)

    def send(self, data: bytes, address: Hashable) -> None:
        """Publish the frames in `data` for one program."""
        while data:
            header = read_header(data)
            size = len(data) if header is None else header.size
            self._send_frame(data[:size], header, str(address))
            data = data[size:]

    def refusal(self, data: bytes) -> str | None:
        """Return which role this program lacks to send a frame; None if it may, or its role is not known."""
        frame = self._read(data) if self._role not in (None, SigningRole.SET_UP) else None
        return None if frame is None else self._role_missing(frame)

    def set_interest(self, systems: frozenset[int] | None) -> None:
        """Let the vehicles with these system ids send all of their telemetry, and the others a little; None: all."""
        self._interesting = systems
        self._ask_for_brief()

    def outlet(self, address: Hashable) -> Outlet | None:
        """Return None: a session cannot be handed to another process."""
        return None

    def close(self) -> None:
        """End the session."""
        for timer in (self._timer, self._delivery):
            if timer:
                timer.cancel()
        self._loop = None
        self._session.close()

    def _read(self, data: bytes) -> Frame | None:
        if data is not self._newest[0]:
            self._newest = data, read_frame(data, self._framer)
        return self._newest[1]

    def _send_frame(self, data: bytes, header: Header | None, address: str) -> None:
        way = None if header is None or header.size != len(data) else self._ways.get((address, header.message_id))
        if way is None:
            way = self._find_way(data, address)
        if header is not None and header.message_id == Heartbeat.id and not self._keys.me:
            self._note_heartbeat(data)
        if way is None or header is None or not self._publish(way, data, header, address):
            self._unsent += 1

    def _publish(self, way: str, data: bytes, header: Header, address: str) -> bool:
        return not self._brief.passes(header, address, time.monotonic()) or self._session.publish(way, data)

    def _find_way(self, data: bytes, address: str) -> str | None:
        """Return the key under which to publish a frame; None for what is not a whole frame, or lacks a role.

        The next ones to the same address go the same way: what a channel sends or forwards is whole.
        """
        frame = self._read(data)
        if frame is None:
            return None
        if why := self._role_missing(frame):
            self._say(f"a message was not sent: {why}", f"{frame[0]}")
            return None
        way = self._keys.place(frame, address, self._claimed_role(frame))
        if not depends_on_content(frame[0]):
            if len(self._ways) >= MAX_KEYS:
                self._ways.clear()
            self._ways[address, frame[0]] = way
        return way

    def _role_missing(self, frame: Frame) -> str | None:
        if not self._keys.me or self._role is None:
            return None
        needed = needed_role(frame)
        if needed <= self._role or self._claimed_role(frame) is SigningRole.WATCH:
            return None
        return f"the certificate of {self._name} may {self._role.word} only; ask for the role {needed.word}"

    def _claimed_role(self, frame: Frame) -> SigningRole | None:
        """Return WATCH for what a watcher may send in these circumstances; None for the role that the frame needs.

        A ground station does not see what others transfer: the vehicle's end decides that.
        """
        condition = watch_condition(frame) if self._role is SigningRole.WATCH else None
        if condition is None or (condition is WatchCondition.HOLD and not self._circumstances.holds(target_of(frame))):
            return None
        return SigningRole.WATCH

    # ---- from threads of Zenoh ----

    def handle_oversized(self) -> None:
        """Count what is too long for a frame."""
        self._oversized += 1

    def handle_frame(self, key: str, data: bytes) -> None:
        """Keep a frame for the loop, and wake it if need be."""
        loop, place = self._loop, self._reader.find(key)
        may_wait = place is not None and place.is_telemetry
        if loop is not None and self._arrivals.put(key, data, loop.time(), may_wait=may_wait):
            self._call(loop, self._deliver)

    def handle_token(self, key: str, is_there: bool) -> None:
        """Tell the loop who came or has gone."""
        address, brief = self._keys.read_token(key), self._keys.read_brief(key)
        if self._loop is not None and address is not None:
            self._call(self._loop, partial(self._note_token, address, is_there))
        if self._loop is not None and brief is not None:
            self._call(self._loop, partial(self._brief.set, brief, is_brief=is_there))

    def handle_connected(self) -> None:
        """Tell the loop that a router is connected."""
        if self._loop is not None:
            self._call(self._loop, partial(self._note_problem, None))

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
        """Hand over what has arrived, and plan when to look again."""
        loop, timer, self._delivery = self._loop, self._delivery, None
        if timer:
            timer.cancel()
        if loop is None:
            return
        now = loop.time()
        taken, more = self._take(now)
        if more:
            self._arrivals.expect(now=True)
            loop.call_soon(self._deliver)
        elif taken and now - self._delivered_at < 2 * PACE:
            self._arrivals.expect(now=False)
            self._delivery = loop.call_later(PACE, self._deliver)
        if taken:
            self._delivered_at = now
        if mine := [(data, address) for data, address in taken if self._is_owner(data, address)]:
            self._on_receive(mine)

    def _take(self, now: float) -> tuple[list[tuple[bytes, str]], bool]:
        """Return the frames to hand over now, and whether more wait."""
        may_pass = self._inbox.is_empty
        fresh: list[tuple[bytes, str]] = []
        for key, data, at in self._arrivals.take():
            found = self._check(key, data)
            if found is None:
                continue
            if may_pass and found.is_telemetry and len(fresh) < BATCH and now - at <= STALE:
                fresh.append((data, found.sender))  # no older telemetry waits in the inbox
            else:
                self._inbox.put(found.sender, data, at)
        taken, more = self._inbox.take(now)
        return taken + fresh, more or not self._arrivals.is_empty

    def _check(self, key: str, data: bytes) -> FleetPlace | None:
        """Return who sent a frame, if it is the one that its key names."""
        found = self._reader.read(key, data)
        if found is None:
            self.refused += 1
            self._refused_key = key  # the next tick says so: a flood must not keep the loop busy
            return None
        place, frame = found
        return place if self._keys.me or self._is_allowed(place, frame) else None

    def _is_allowed(self, place: FleetPlace, frame: Frame) -> bool:
        """Return whether a frame to this vehicle may come from its sender now."""
        now = time.monotonic()
        if place.is_conditional(frame) and not self._circumstances.allows_watcher(frame, place.sender, now):
            self.refused += 1
            self._say("a watcher's frame was dropped: it would end another's transfer, or is not a stop", place.sender)
            return False
        self._circumstances.note_transfer(frame, place.sender, now)
        return True

    def _is_owner(self, data: bytes, address: str) -> bool:
        """Return whether a frame's system id is that of its vehicle; two vehicles with one id would look like one."""
        header = read_header(data)
        if header is None or not self._keys.me:
            return header is not None
        owner = self._presence.owner(header.system, address)
        if owner != address:
            self.refused += 1
            self._say(f"{address} sends with system id {header.system} of {owner}: give it another MAV_SYSID", address)
        elif header.message_id == Heartbeat.id:
            self._note_heartbeat(data)
        return owner == address

    def _note_heartbeat(self, data: bytes) -> None:
        """Learn from a vehicle's HEARTBEAT of which autopilot it is."""
        if frame := self._read(data):
            self._circumstances.note_heartbeat(frame)

    def _note_token(self, address: str, is_there: bool) -> None:
        if self._loop is None:
            return
        if not is_there:
            self._presence.remove(address, self._loop.time())
            return
        if self._keys.me:
            if self._interesting is not None and address not in self._presence.find_owners(self._interesting):
                self._session.show_token(self._keys.brief_token(address))  # before it can send anything
            self._session.show_token(self._keys.token(address))
        if self._presence.add(address):
            log.debug("%s: %s is connected", self.endpoint.text, address)
            self._on_receive([(b"", address)])

    def _ask_for_brief(self) -> None:
        """Tell each vehicle whether this ground station looks at it."""
        if not self._keys.me:
            return
        whole = None if self._interesting is None else self._presence.find_owners(self._interesting)
        for address in self._presence.present:
            tell = self._session.hide_token if whole is None or address in whole else self._session.show_token
            tell(self._keys.brief_token(address))

    def _note_problem(self, problem: str | None) -> None:
        self.problem = None if problem is None else f"{self.endpoint.text}: {problem}"
        if problem is not None and self._loop is not None:  # without a session nobody is seen
            self._brief.keep(self._presence.present)
            for address in self._presence.present:
                self._presence.remove(address, self._loop.time())

    def _tick(self, loop: asyncio.AbstractEventLoop) -> None:
        for address in self._presence.expire(loop.time()):
            log.debug("%s: %s has disconnected", self.endpoint.text, address)
            self._inbox.forget(address)
            self._brief.set(address, is_brief=False)
            self._circumstances.forget_sender(address)
            self._on_disconnect(address)
        self._ask_for_brief()  # of those that have come, and whose system id has become known
        if self._refused_key:
            self._say("frames were dropped: they are not what their key names", self._refused_key)
            self._refused_key = ""
        if self._oversized != self._oversized_said:
            self._say("a member sends what is too long for a frame; dropped", f"{self._oversized} in all")
            self._oversized_said = self._oversized
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
