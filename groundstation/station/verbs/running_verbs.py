"""RunningVerbs: the verbs that run in this station. Their messages leave as the station's own. Time is an argument.

A verb says what it sends each message for (Purpose). Commands and stops always pass: they are the user's. A demand that
moves passes only while no screen drives and no other verb does, and ends with neutral when the verb ends, is killed or
stands still. The station proves its session to the vehicle that its screen drives; for others, and without a screen, a
verb's proofs become those of the session.

A verb that only looks keeps no vehicle from its failsafe, unless it follows: it begins at most KEEP s after a verb that
took part, and goes on with the session until a screen drives. It steps aside while another verb takes part.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from enum import Enum, auto
from typing import Any, NamedTuple, Protocol

import msgspec

from dialects import messages as m
from dialects.enums import Severity
from dialects.traits import ACKED, is_stop, only_asks
from groundstation.station.driving.operator import OperatorSession
from groundstation.station.driving.proofs import IDLE_PROOF_PERIOD, SessionProofs
from groundstation.station.outbox import StationOutbox
from groundstation.station_socket.verb_run import ALIVE_WITHIN, KEEP
from groundstation.vehicles.demand.demand_neutrals import DEMANDS
from groundstation.vehicles.demand.demand_stream import DRIVING_PERIOD, FINAL_NEUTRALS
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.state.message_log import MessageLog
from groundstation.vehicles.state.vehicle_heartbeat import MAX_VEHICLES, is_vehicle
from link.core import LinkReport, Outgoing, Peer, Received

FRESH = 3.0
"""s for which the newest message of a kind is news for a verb that connects."""

CONSTANT = frozenset((m.AutopilotVersion.id, m.RoverDriveInfo.id, m.HomePosition.id))
"""Ids of messages that a vehicle sends once, and that hold as long as it is heard."""

STOPPED = "a person has stopped it at a screen"

MAX_KINDS = 64 * MAX_VEHICLES
"""Kinds of messages, of all senders together, whose newest is kept."""


_READS = (m.ParamRequestRead, m.ParamRequestList, m.MissionRequestList, m.MissionRequestInt, m.MissionRequest,
          m.MissionAck, m.LogRequestList, m.Timesync, m.Ping)  # fmt: skip
"""Messages that only read. An agent may send them, stops and questions without a person."""


class Purpose(Enum):
    """What a verb sends a message for."""

    OTHER = auto()
    PRESENCE = auto()
    """A HEARTBEAT, so that vehicles do not miss their ground station."""
    PROOF = auto()
    """Proves the session to its vehicle."""
    NEUTRAL = auto()
    """A demand without motion; it ends a MOTION of its kind."""
    MOTION = auto()
    """A demand that moves, or that only a neutral ends."""


class VerbMessage(NamedTuple):
    """A message of a verb."""

    message: m.Message
    purpose: Purpose = Purpose.OTHER


class VerbSeat(Protocol):
    """What joins the core of a verb to the station."""

    def deliver(self, received: Received, now: float) -> None:
        """Handle a message that the station has received."""

    def report(self, reports: Sequence[LinkReport], now: float) -> None:
        """Handle the state of the links."""

    def refuse(self, line: str) -> None:
        """End the verb: its demand is not sent, or not any more."""

    def tell_refusal(self, message: m.Message, why: str, now: float) -> None:
        """Note that a message of the verb is not sent, because our role does not allow it."""

    def tick(self, now: float) -> None:
        """Let the verb send what is due."""


class RunningVerb(msgspec.Struct, eq=False):
    """One verb."""

    name: str
    needs_session: bool
    seat: VerbSeat
    follows: bool = False
    """It keeps the session going that a verb has used just before."""
    moves: bool = False
    """It drives, or begins what drives: a person who stops the vehicle ends it."""
    is_permitted: Callable[[float], bool] | None = None
    """Of a verb of an agent: whether a person lets it act now. None: it is the user's own."""
    alone: bool = False
    """The station is that of its own process: nobody else drives there, and its watchdog ends what it demands."""
    heard_at: float = 0.0
    demands: dict[tuple[type[m.Message], int], m.Message] = msgspec.field(default_factory=dict)
    """Kind and vehicle -> the newest demand that moves."""
    refused: str = ""
    """Why no more demands are taken."""


class _Ending(msgspec.Struct):
    """A demand that ends with neutral."""

    contact: Contact
    messages: list[m.Message]
    left: int
    due: float


class RunningVerbs:
    """The verbs of one station."""

    def __init__(
        self, fleet: Fleet, operator: OperatorSession, proofs: SessionProofs, log: MessageLog, outbox: StationOutbox
    ) -> None:
        self._fleet = fleet
        self._operator, self._proofs = operator, proofs
        self._log = log
        self.screen_that_drives: Callable[[], str | None] = lambda: None
        """Returns its name; None without one."""
        self._verbs: list[RunningVerb] = []
        self._newest: dict[tuple[int, int, int, Peer | None], tuple[Received, float]] = {}
        """System, component and message id -> the newest; a HEARTBEAT of each sender, because two may have one id."""
        self._reports: tuple[LinkReport, ...] = ()
        self._endings: list[_Ending] = []
        self._used_at = -math.inf
        """When a verb without a screen beside it last used the session."""
        self._proven: dict[int, float] = {}
        """System id -> when the session was last proven to it for a verb."""
        self._outbox = outbox.demands.verbs
        self._senders: list[tuple[m.Message, RunningVerb]] = []
        """Of the messages of verbs that were queued last; with an empty outbox they are being sent, or are sent."""
        self._sent: list[tuple[m.Message, RunningVerb]] = []
        """The same of those before."""

    def may_follow(self, now: float) -> bool:
        """Return whether a verb that only looks may go on with the session of the verb before."""
        return not self._operator.live and now - self._used_at <= KEEP

    def join(self, verb: RunningVerb, now: float) -> None:
        """Start a verb, and report the present state to it."""
        verb.heard_at = now
        verb.seat.report(self._reports, now)
        # The HEARTBEAT first: a verb takes nothing from a vehicle that it does not know.
        newest = sorted(self._newest.values(), key=lambda each: (not is_vehicle(each[0].message), each[1]))
        for received, at in newest:
            if now - at <= FRESH or self._holds(received, now):
                verb.seat.deliver(received, now)
        self._verbs.append(verb)

    def leave(self, verb: RunningVerb, now: float) -> None:
        """Forget a verb that has ended; what it demanded ends with neutral."""
        self._verbs.remove(verb)
        self._end_demands(verb, now)

    def end(self, now: float) -> None:
        """End what all verbs demand with neutral, and take no more of them: the station ends."""
        for verb in self._verbs:
            self._refuse(verb, "the station ends", now)

    # ---- from the vehicles ----

    def receive(self, received: Received, now: float) -> None:
        """Pass a message on to all verbs, and keep it for the next one; without the key of a SETUP_SIGNING."""
        if type(received.message) is m.SetupSigning:
            received = received._replace(message=m.hide_key(received.message))
        number = type(received.message).id
        if number not in ACKED:
            if len(self._newest) >= MAX_KINDS:
                self._newest.clear()
            peer = received.peer if number == m.Heartbeat.id else None
            self._newest[received.system, received.component, number, peer] = (received, now)
        for verb in list(self._verbs):
            verb.seat.deliver(received, now)

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        """Pass the state of the links on."""
        self._reports = tuple(reports)
        for verb in self._verbs:
            verb.seat.report(self._reports, now)

    def _holds(self, received: Received, now: float) -> bool:
        """Return whether a message is still true, however old."""
        contact = self._fleet.get(received.system) if type(received.message).id in CONSTANT else None
        return contact is not None and contact.state.monitor.is_alive(now)

    # ---- from the verbs ----

    def handle(self, verb: RunningVerb, said: VerbMessage, now: float) -> None:
        """Send a message of a verb, if it may be sent."""
        message = said.message
        if not verb.alone and not self._may_pass(verb, said, now):
            return
        if not self._outbox:
            self._sent, self._senders = self._senders, []
        self._prove(verb, message, now)
        self._outbox.append(Outgoing(message))
        self._senders.append((message, verb))

    def _may_pass(self, verb: RunningVerb, said: VerbMessage, now: float) -> bool:
        if verb.is_permitted is not None and not verb.is_permitted(now):
            return said.purpose is Purpose.OTHER and _changes_nothing(said.message)
        if said.purpose is Purpose.OTHER:
            return True
        if said.purpose is Purpose.PRESENCE:
            return not self._operator.live and (self._keeps(verb) or not self._any_armed)
        return self._keeps(verb) and self._may_demand(verb, said, now)

    def hear(self, verb: RunningVerb, now: float) -> None:
        """Note that a verb runs. One that stood still has lost its demands, and makes no others."""
        self._check_silence(verb, now)
        verb.heard_at = now
        if not self._operator.live and self._keeps(verb):
            self._used_at = now

    def stop(self, now: float) -> None:
        """End the verbs that move vehicles, with neutral: a person at a watching screen has stopped.

        While a screen drives, no verb does, and its stops are for its own keys. What an agent does ends by itself.
        """
        if self.screen_that_drives() is not None:
            return
        for verb in list(self._verbs):
            if not verb.alone and verb.is_permitted is None and (verb.moves or verb.demands):
                self._refuse(verb, STOPPED, now)
                verb.seat.refuse(STOPPED)

    def tick(self, now: float) -> None:
        """End the demands of verbs that stand still, or that a screen has taken over; send what ends them."""
        screen = self.screen_that_drives()
        if self._operator.live:
            self._used_at = -math.inf
        for verb in list(self._verbs):
            verb.seat.tick(now)
            verb.follows &= not self._operator.live
            self._check_silence(verb, now)
            if verb.is_permitted is not None and verb.demands and not verb.is_permitted(now):
                self._refuse(verb, "its permission has ended", now)
            elif screen is not None and verb.demands and verb.is_permitted is None:
                self._refuse(verb, f"the {screen} drives", now)
        for ending in list(self._endings):
            self._continue(ending, now)

    def handle_refused(self, message: m.Message, why: str, now: float) -> bool:
        """Tell the verb whose message our role does not allow; return whether it is one of a verb."""
        verb = next((verb for sent, verb in (*self._sent, *self._senders) if sent is message), None)
        if verb is not None:
            verb.seat.tell_refusal(message, why, now)
        return verb is not None

    def tell_alone(self, message: m.Message, why: str, now: float) -> None:
        """Tell a verb that has the station for itself: whatever is requested here is its own."""
        for verb in self._verbs:
            if verb.alone:
                verb.seat.tell_refusal(message, why, now)

    def drives_for_operator(self, system: int, now: float) -> bool:
        """Return whether a verb demands motion of this vehicle that a person permits at this moment."""
        return any(
            verb.is_permitted is not None and verb.is_permitted(now) and any(to == system for _, to in verb.demands)
            for verb in self._verbs
        )

    @property
    def busy(self) -> bool:
        """Whether a verb runs, which may send its last messages yet, or what one demanded is being ended."""
        return bool(self._verbs or self._endings)

    @property
    def uses_services(self) -> bool:
        """Whether a verb runs, so that the services of vehicles are used although no screen is there."""
        return bool(self._verbs)

    @property
    def _any_armed(self) -> bool:
        return any(contact.state.armed for contact in self._fleet)

    def _keeps(self, verb: RunningVerb) -> bool:
        """Return whether a verb keeps vehicles from missing their ground station."""
        return (
            verb.alone or verb.needs_session or (verb.follows and not any(each.needs_session for each in self._verbs))
        )

    def _may_demand(self, verb: RunningVerb, said: VerbMessage, now: float) -> bool:
        """Return whether to send a demand or a proof; refuse one that moves while somebody else drives."""
        message, contact = said.message, self._fleet.get(m.target_system(said.message))
        if contact is None:
            return False
        other = next((each for each in self._verbs if each is not verb and each.demands), None)
        if said.purpose is not Purpose.MOTION:
            ends = verb.demands.pop((type(message), contact.state.system), None) is not None
            if said.purpose is Purpose.NEUTRAL and other is not None and not ends:
                return False  # a verb that waits for its turn does not brake the one that drives
            return not contact.demand_stream.streaming  # else the station sends them
        screen = self.screen_that_drives() if verb.is_permitted is None else None
        if not verb.refused and (screen or other):
            self._refuse(verb, f"the {screen or (other.name if other else '')} drives", now)
        if verb.refused:
            verb.seat.refuse(verb.refused)
            return False
        verb.demands[type(message), contact.state.system] = message
        return True

    def _prove(self, verb: RunningVerb, message: m.Message, now: float) -> None:
        """Prove the session before a message that may need control; a live screen does so all the time."""
        contact = self._fleet.get(getattr(message, "target_system", 0))
        if contact is None or not contact.state.has_rover_dialect or not verb.needs_session or self._operator.live:
            return
        proof = isinstance(message, m.RoverOperatorPresence)
        if not proof and now - self._proven.get(contact.state.system, -math.inf) >= IDLE_PROOF_PERIOD:
            self._outbox.append(Outgoing(self._proofs.build(contact.state, self._operator, now)))
            proof = True
        if proof:
            self._proven[contact.state.system] = now

    def _check_silence(self, verb: RunningVerb, now: float) -> None:
        silence = now - verb.heard_at
        if verb.demands and silence > ALIVE_WITHIN:
            self._refuse(verb, f"{verb.name} stood still for {silence:.1f} s: its demand has ended", now)

    def _refuse(self, verb: RunningVerb, reason: str, now: float) -> None:
        verb.refused = reason
        if verb.demands:
            self._log.add(now, "station", f"{verb.name} stopped: {reason}", Severity.WARNING)
        self._end_demands(verb, now)

    def _end_demands(self, verb: RunningVerb, now: float) -> None:
        """Send neutral in the place of a verb, several times."""
        for (kind, system), demand in verb.demands.items():
            contact = self._fleet.get(system)
            if contact is not None and kind in DEMANDS:
                messages = DEMANDS[kind](contact.state, _values(demand), now)
                self._endings.append(_Ending(contact, messages, FINAL_NEUTRALS, now))
        verb.demands.clear()
        for ending in list(self._endings):
            self._continue(ending, now)

    def _continue(self, ending: _Ending, now: float) -> None:
        if now < ending.due:
            return
        state, neutral = ending.contact.state, ending.messages[0]
        if state.has_rover_dialect and isinstance(neutral, m.ManualControl):
            self._outbox.append(Outgoing(self._proofs.build(state, self._operator, now, neutral)))
        self._outbox += [Outgoing(message) for message in ending.messages]
        ending.left, ending.due = ending.left - 1, now + DRIVING_PERIOD
        if not ending.left:
            self._endings.remove(ending)


def _changes_nothing(message: m.Message) -> bool:
    return is_stop(message) or only_asks(message) or isinstance(message, _READS)


def _values(message: m.Message) -> dict[str, Any]:
    return {name: getattr(message, name) for name in message.fieldnames}
