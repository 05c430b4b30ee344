"""Which ground station is in control: who takes it, who succeeds a silent driver, and what others are told.

The rules of identity are in driver.py and conversation.py. Demands and the neutral-first interlock are in control.py.

Operations wanted: say for each message whether its sender may drive, command or take control (`is_driver`,
`denial_reason`, `takeover_denial_reason`), and pass control on (`take`, `release`, `succeed`).

Worst case: another program sends with the ids of the driver, from its address, or sends recorded frames of it. Ids
prove nothing then. A driver with a session proves each demand; without one, two runs of numbers at once are a clash
that bars both for a while, and frames that repeat older ones are a copy, whose demands do not count.

Why not simpler: with the system id as the owner, two ground stations with the default id 255 would drive in turns, and
a recording of yesterday would drive at all. A rule that only refused strangers would leave a rover without a driver
after each restart of a ground station, so that succession has rules of its own: silence first, and an act, not a
heartbeat.
"""

from __future__ import annotations

import math

from dialects import messages as m
from dialects.enums import Severity
from dialects.traits import COMMANDS, DEMANDS, only_asks
from link.core import Peer, Received
from link.signing.role import SigningRole
from vehicle.drive.conversation import Conversation, FrameMemory, Newcomer, Sender
from vehicle.drive.driver import CLASH_PAUSE, Driver
from vehicle.drive.operator_session import PROOF_VALID, SENDERS_MAX, DrivingSession, Proof, RecentProofs
from vehicle.drive.roles import role_denial
from vehicle.params import Params
from vehicle.statustext import StatusTextQueue

REPORT_AGAIN = 60.0
"""s after which the driver is told again of another program with its ids."""
LINK_TIME = 2.0
"""s in which a further link of the driver's session brings its first proof: five a second come while it is armed, and
all ten are lost once in 165 at 60 % loss. Sooner it is not called another program."""
CLASH_REPORT_AGAIN = 10.0
"""s after which a clash is reported again."""
_SETPOINTS = {each.id for each in (m.SetPositionTargetLocalNed, m.SetPositionTargetGlobalInt, m.SetAttitudeTarget)}
_STREAMED = frozenset(DEMANDS | _SETPOINTS)
"""Message ids of demands: a driver that has sent some is soon missed."""
_ACTS = (_STREAMED | COMMANDS) - {m.RoverOperatorPresence.id}
"""Message ids with which a program succeeds a silent driver: not a heartbeat, and not the proof of a session, which is
checked first (vehicle/drive/control.py). A command that only asks does not count either: who looks is not a driver."""


class Ownership:
    """The driver ("owner"), and how control passes from one ground station to another."""

    def __init__(self, params: Params, texts: StatusTextQueue, boot: float) -> None:
        self.driver: Driver | None = None
        self.takeover_allowed = False
        """Other ground stations may take control without the consent of the owner."""
        self._params = params
        self._texts = texts
        self._heard = boot
        """When a driver that has left was heard last; the boot before there was one."""
        self._proofs = RecentProofs()
        self._proof_at: dict[Conversation, float] = {}
        """Sender -> when its newest proof came, good or not; the newest last."""
        self._memory = FrameMemory()

    # ---- questions ----

    @property
    def owner(self) -> int:
        """System id of the driver, 0 if there is none."""
        return self.driver.conversation.system if self.driver else 0

    @property
    def session(self) -> DrivingSession | None:
        """The session of the driver; None for a ground station whose demands carry no proof of their age."""
        return self.driver.session if self.driver else None

    def driver_proves(self, now: float) -> bool:
        """Return whether the driver has sent a proof of the age of its demands, good or not, within PROOF_VALID."""
        at = -math.inf if self.driver is None else self._proof_at.get(self.driver.conversation, -math.inf)
        return now - at <= PROOF_VALID

    def is_driver(self, sender: Sender, now: float) -> bool:
        """Return whether a message or command is from the driver, with a key that may drive."""
        return self.driver is not None and sender.role >= SigningRole.DRIVE and self.driver.is_sender(sender, now)

    def has_driver_ids(self, sender: Sender) -> bool:
        """Return whether a sender has the ids of the driver, and may yet be another program."""
        return self.driver is not None and self.driver.conversation.ids == (sender.system, sender.component)

    def is_barred(self, sender: Sender, now: float) -> bool:
        """Return whether this is the driver, but cannot be told from another program for the moment."""
        return self.driver is not None and self.driver.is_barred(now) and self.is_driver(sender, now)

    def accepts_unproven_demand(self, now: float) -> bool:
        """Return whether a demand of the driver that carries no proof counts now."""
        driver = self.driver
        return driver is not None and driver.session is None and not (driver.is_copy or driver.is_barred(now))

    def silence_duration(self, now: float) -> float:
        """Return the s since the last message of the driver, or of the one before; without any, since boot."""
        return now - self._last_heard

    @property
    def lost_at(self) -> float:
        """From when on the driver is lost if it sends nothing more."""
        timeout: float = self._params["FS_GCS_TIMEOUT"]
        return self._last_heard + timeout

    @property
    def _last_heard(self) -> float:
        return self.driver.last_heard if self.driver else self._heard

    def is_lost(self, now: float) -> bool:
        """Return True if the driver has sent nothing for FS_GCS_TIMEOUT."""
        return self.silence_duration(now) > self._params["FS_GCS_TIMEOUT"]

    def is_silent(self, now: float) -> bool:
        """Return whether another program with the driver's ids may take over, if it has a session."""
        timeout = self._params["FS_GCS_TIMEOUT"]
        return self.driver is not None and self.driver.may_be_succeeded(now, by_session=True, timeout=timeout)

    def denial_reason(self, sender: Sender, now: float) -> str | None:
        """Return why a sender may not command, or None if it is in control or no ground station is."""
        if denial := role_denial(sender, SigningRole.DRIVE):
            return denial
        if self._is_excluded(sender):
            return f"only GCS {self._params['MAV_GCS_SYSID']:g} may control (MAV_GCS_SYSID)"
        driver = self.driver
        if driver is None:
            return None
        if not self.is_driver(sender, now):
            return self._other_reason(driver, sender, now)
        return f"two programs count as {driver.name}" if driver.is_barred(now) else None

    def takeover_denial_reason(self, sender: Sender, now: float) -> str | None:
        """Return why a sender may not take control, or None if it may."""
        reason = self.denial_reason(sender, now)
        if (
            sender.role < SigningRole.DRIVE
            or self._is_excluded(sender)
            or not (self.takeover_allowed or self.is_lost(now))
        ):
            return reason
        return None

    def may_be_given_to(self, sender: Sender) -> bool:
        """Return whether the driver may give control to a sender that asks for it."""
        return sender.role >= SigningRole.DRIVE and not self._is_excluded(sender) and not self.has_driver_ids(sender)

    def setpoint_denial_reason(self, sender: Sender, now: float) -> str | None:
        """Return why a setpoint does not count, or None: only the driver's do, and only fresh ones."""
        reason, driver = self.denial_reason(sender, now), self.driver
        if reason or driver is None:
            return reason or "no GCS is in control, arm to take it"
        if driver.session is None:
            return "it repeats old frames" if driver.is_copy else None
        age = driver.session.setpoint_age(Conversation.of(sender), now)
        return "older than OPR_ECHO_MAX on arrival" if age > self._params["OPR_ECHO_MAX"] else None

    def missing_proof(self, sender: Sender, now: float) -> str | None:
        """Return why a link of the driver's own session may not command for the moment, or None.

        It may again with its next good proof, so that its sender need only repeat what it has sent.
        """
        driver = self.driver
        if driver is None or driver.session is None or sender.role < SigningRole.DRIVE or self._is_excluded(sender):
            return None
        link = driver.session.links.get(Conversation.of(sender))
        if link is None or driver.is_sender(sender, now):
            return None
        if link.age > self._params["OPR_ECHO_MAX"]:
            return f"this link is {link.age:.1f} s late"
        return f"no proof on this link for {now - link.proven_at:.1f} s"

    def may_be_link(self, sender: Sender, now: float) -> bool:
        """Return whether a sender may yet prove to be another link of the driver's session; until then it is nobody."""
        driver = self.driver
        if driver is None or driver.session is None or not self.has_driver_ids(sender):
            return False
        newcomer = self._memory.newcomer(Conversation.of(sender))
        return newcomer is None or now - newcomer.begun_at < LINK_TIME

    def _is_excluded(self, sender: Sender) -> bool:
        return self._params["MAV_GCS_SYSID"] not in (0, sender.system)

    def _other_reason(self, driver: Driver, sender: Sender, now: float) -> str:
        """Return why a sender that is not the driver may not command."""
        if reason := self.missing_proof(sender, now):
            return reason
        if self.has_driver_ids(sender):
            return f"another program with your ids {driver.name} is in control, use other ids"
        return f"GCS {driver.conversation.system} is in control"

    # ---- changes ----

    def take(self, conversation: Conversation, now: float) -> bool:
        """Give control to a conversation, to the session that it has proven. Return True if it was not in control.

        Without a proof in the last second it counts as a ground station without sessions, until it takes control again:
        a proof that comes later may be that of another program with the same ids.
        """
        session = self._proofs.session_of(conversation, now)
        if self.driver is not None and self.driver.is_sender(conversation, now):
            self.driver.session = self.driver.session or session
            self.driver.last_heard = now
            return False
        self._set_driver(conversation, session, now)
        self.takeover_allowed = False
        self._texts.reset_once("demand")
        self._texts.send_event(Severity.NOTICE, f"GCS {conversation.system} is in control", now)
        return True

    def release(self, why: str, now: float) -> None:
        """Release control; `why` completes the STATUSTEXT."""
        self._texts.send_event(Severity.NOTICE, f"No GCS is in control: GCS {self.owner} {why}", now)
        self._texts.reset_once("demand")
        self._heard = self._last_heard
        self.driver = None

    def other_peers(self, sender: Sender, now: float) -> list[Peer]:
        """Return where else the ground station of a sender is: its transfers go on over each of its links."""
        conversation = Conversation.of(sender)
        return [each.peer for each in self._proofs.links_of(conversation, now) if each.peer != conversation.peer]

    def add_proof(self, conversation: Conversation, proof: Proof, now: float, *, good: bool) -> None:
        """Note a proof of an introduced ground station; that of the driver's session has the driver's ids."""
        if good:
            self._proofs.add(conversation, proof, now)
        self._proof_at.pop(conversation, None)
        self._proof_at[conversation] = now
        if len(self._proof_at) > SENDERS_MAX:
            del self._proof_at[next(iter(self._proof_at))]
        driver = self.driver
        if driver is None or driver.session is None or not self.has_driver_ids(conversation):
            return
        if proof.session != driver.session.id:
            return
        driver.session.add_proof(conversation, proof, now, good=good)
        if good:
            driver.last_heard = now
            driver.conversation = conversation

    def hear(self, received: Received, now: float) -> bool:
        """Note a message of an introduced sender; return True if it has succeeded the driver.

        All messages of a driver without sessions keep the failsafe quiet: heartbeats alone gave false alarms on lossy
        links.
        """
        driver = self.driver
        if driver is None:
            self._memory.note_newcomer(received, now)
            return False
        if driver.session is None and received.clash and self._is_beside_driver(driver, received):
            self._handle_clash(driver, now)
        elif not driver.is_sender(received, now):
            return self._hear_newcomer(driver, received, now)
        else:
            if driver.session is None:
                is_demand = type(received.message).id in _STREAMED
                driver.hear(now, is_demand=is_demand, repeated=self._memory.is_repeat(received))
            self._memory.record(received)
        return False

    def succeed(self, conversation: Conversation, session: DrivingSession | None, now: float) -> bool:
        """Let another program with the driver's ids take over if the driver is silent; return whether it does."""
        driver = self.driver
        timeout = self._params["FS_GCS_TIMEOUT"]
        if driver is None or not driver.may_be_succeeded(now, by_session=session is not None, timeout=timeout):
            return False
        self._set_driver(conversation, session, now)
        text = f"GCS {self.owner} drives from another program now: release the keys first"
        self._texts.send_event(Severity.NOTICE, text, now)
        return True

    def report_other_session(self, conversation: Conversation, now: float) -> None:
        """Tell the driver of another session with its ids."""
        newcomer = self._memory.newcomer(conversation)
        if self.driver is not None and newcomer is not None:
            self._report(self.driver, newcomer, now)

    def _report(self, driver: Driver, newcomer: Newcomer, now: float) -> None:
        if now - newcomer.reported_at < REPORT_AGAIN:
            return
        newcomer.reported_at = now
        text = f"Another program uses your ids {driver.name}: it may only stop"
        self._texts.reply(driver.conversation, Severity.WARNING, text, now)

    def _set_driver(self, conversation: Conversation, session: DrivingSession | None, now: float) -> None:
        newcomer = self._memory.newcomer(conversation)
        self._memory.begin(conversation)
        is_copy = newcomer is not None and newcomer.is_copy
        self.driver = Driver(conversation, session, now, is_copy=is_copy)

    def _hear_newcomer(self, driver: Driver, received: Received, now: float) -> bool:
        """Handle a message of a sender that is not the driver; return True if it has succeeded it."""
        newcomer = self._memory.note_newcomer(received, now)
        if not self.has_driver_ids(received) or not _is_act(received.message):
            return False
        conversation = Conversation.of(received)
        session = self._proofs.session_of(conversation, now)
        if (session is not None or newcomer.is_program) and self.succeed(conversation, session, now):
            return True
        is_link = driver.session is not None and conversation in driver.session.links
        if newcomer.is_program and not is_link and not self.may_be_link(received, now):
            self._report(driver, newcomer, now)
        return False

    @staticmethod
    def _is_beside_driver(driver: Driver, received: Received) -> bool:
        """Return whether a sender has the ids of the driver, at its peer."""
        conversation = driver.conversation
        return (received.system, received.component, received.peer) == (*conversation.ids, conversation.peer)

    def _handle_clash(self, driver: Driver, now: float) -> None:
        """Let no demand count for a while: the driver cannot be told from another program."""
        driver.barred_until = now + CLASH_PAUSE
        if now - driver.clash_reported_at > CLASH_REPORT_AGAIN:
            driver.clash_reported_at = now
            text = f"Two programs count as {driver.name} behind one address: stopped"
            self._texts.send_event(Severity.CRITICAL, text, now)


def _is_act(message: m.Message) -> bool:
    """Return whether a program succeeds a silent driver with this message."""
    return type(message).id in _ACTS and not only_asks(message)
