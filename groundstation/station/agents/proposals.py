"""ProposalBook: what agents propose, and the key of a person that lets one proposal run. Time is an argument.

A proposal waits on the screens, at most MOST_WAITING of them, and each for a limited time. The oldest one is shown.
It runs while the key of PermitProposal is held at the screen that drives, and no longer than its bounds allow. Its
first event begins it; an end is final, and the next proposal needs a new press. What the vehicle does by itself when
the permission ends is stopped with HOLD.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from enum import Enum, auto

import msgspec

from dialects.enums import Severity
from dialects.mode_tables import HOLD
from dialects.printable import printable
from groundstation.intents.agents import DeclineProposal, EndPermission, PermitProposal
from groundstation.intents.base import Intent
from groundstation.intents.vehicle_intent import HOLD_TIME
from groundstation.snapshot.agents import ProposalView
from groundstation.station.driving.commander import Commander
from groundstation.station.driving.operator import OperatorSession
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.state.message_log import MessageLog

MOST_WAITING = 4
"""Proposals that wait at once, of all agents together."""
LONGEST_WAIT = 60.0
"""s for which a proposal may wait for a person."""
PERMIT_WINDOW = 0.25
"""s after the newest event of the key for which it counts as held: the longest window of a key that repeats."""
AGENT_SILENCE = 0.35
"""s without a sign of life of the agent after which what runs ends: with a tick and a link it stops within 0.5 s."""
HOLD_AGAIN = 3.0
"""s after the end for which a vehicle that drives itself gets HOLD: a command of the agent may still be on its way."""
HOLD_PERIOD = 0.5
"""s between two of these."""
NOTE_SIZE = 84
"""Characters of a reason in one note of the recording, whose field has 100 bytes."""
NO_SCREEN = "no screen of this station is open: nothing runs without a person at one"


class ProposalStage(Enum):
    """Where a proposal is."""

    WAITING = auto()
    RUNNING = auto()
    ENDED = auto()


class Proposal(msgspec.Struct, frozen=True):
    """What an agent asks for. Texts are the agent's own and say nothing about who it is."""

    who: str
    """The program, as the station knows it, and in quotes what it calls itself."""
    text: str
    reason: str
    system: int
    seconds: float
    """s for which it may run."""
    wait: float = 30.0
    meters: float | None = None
    """m that the vehicle may cover meanwhile."""


class Ticket(msgspec.Struct, eq=False):
    """One proposal in the book."""

    number: int
    proposal: Proposal
    until: float
    """When it ends, if nobody permits it; while it runs, when its key counts no more."""
    stage: ProposalStage = ProposalStage.WAITING
    began: float = math.inf
    meters: float = 0.0
    """Covered so far."""
    heard_at: float = math.inf
    """When the agent gave its last sign of life."""
    why: str = ""
    """Why it has ended."""
    done: bool = False
    """It has ended because its work was done."""
    changed: Callable[[], None] = lambda: None
    """Called when `stage` changes."""


class _Stopping(msgspec.Struct):
    """A vehicle that gets HOLD again if it drives itself after the end of a permission."""

    contact: Contact
    until: float
    due: float


class ProposalBook:
    """The proposals of one station."""

    def __init__(self, fleet: Fleet, operator: OperatorSession, commander: Commander, log: MessageLog) -> None:
        self._fleet, self._operator, self._commander, self._log = fleet, operator, commander, log
        self.permitting_screen: Callable[[], str | None] = lambda: None
        """Returns the name of the screen whose key permits; None: there is none."""
        self.take_note: Callable[[float, str], None] = lambda now, text: None
        """Writes a line into the recording."""
        self._tickets: list[Ticket] = []
        self._count = 0
        self._measured_at = -math.inf
        self._stopping: _Stopping | None = None

    # ---- agents ----

    def propose(self, proposal: Proposal, now: float) -> Ticket | str:
        """Add a proposal. Return why not."""
        if why := self._refusal(proposal):
            self._note(now, f"agent: proposal refused: {why}: {proposal.text}")
            return why
        self._count += 1
        wait = min(max(proposal.wait, 1.0), LONGEST_WAIT)
        ticket = Ticket(self._count, proposal, now + wait)
        self._tickets.append(ticket)
        self._say(now, f"agent {ticket.number}: {proposal.who} proposes: {proposal.text}", Severity.WARNING)
        self.note_reason(f"agent {ticket.number}", proposal.reason, now)
        return ticket

    def hear(self, ticket: Ticket, now: float) -> None:
        """Note a sign of life of the agent."""
        ticket.heard_at = now

    def finish(self, ticket: Ticket, why: str, now: float, *, done: bool = False) -> None:
        """End a proposal: its work is done or has failed, or the agent does not want it any more."""
        self._end(ticket, why, now, done=done)

    def may_run(self, ticket: Ticket, now: float) -> bool:
        """Return whether what a proposal does may be sent now."""
        return ticket.stage is ProposalStage.RUNNING and self._fault(ticket, now) is None

    def note_call(self, who: str, text: str, reason: str, now: float) -> None:
        """Record a call that needs nobody."""
        self._note(now, f"agent: {who} calls {text}")
        if reason:
            self.note_reason("agent", reason, now)

    def note_reason(self, who: str, reason: str, now: float) -> None:
        """Record a whole reason, in pieces that fit into a note."""
        for at in range(0, len(reason), NOTE_SIZE):
            self._note(now, f"{who} reason: {reason[at : at + NOTE_SIZE]}")

    # ---- the operator ----

    def permit(self, intent: PermitProposal, now: float) -> None:
        """Handle an event of the held key."""
        ticket = self.shown
        if ticket is None or ticket.number != intent.number:
            return
        if ticket.stage is ProposalStage.RUNNING:
            if now < ticket.until:
                ticket.until = now + PERMIT_WINDOW
            return
        screen, blocked = self.permitting_screen(), self._operator.permission_blocked_reason(now)
        if not intent.held >= HOLD_TIME or blocked is not None or screen is None or not self._is_selected(ticket):
            return
        ticket.stage, ticket.until = ProposalStage.RUNNING, now + PERMIT_WINDOW
        ticket.began = ticket.heard_at = self._measured_at = now
        self._say(now, f"agent {ticket.number}: permitted by the key at the {screen}", Severity.WARNING)
        ticket.changed()

    def interrupt(self, intent: Intent, now: float) -> None:
        """End what runs: the operator has let the key go, or has done something else."""
        self._stopping = None
        ticket = self._running if self._tickets else None
        if isinstance(intent, PermitProposal | DeclineProposal) or ticket is None:
            return
        self._end(ticket, "the key was released" if isinstance(intent, EndPermission) else _describe(intent), now)

    def decline(self, intent: DeclineProposal, now: float) -> None:
        """End the proposal that is shown."""
        ticket = self.shown
        if ticket is not None and intent.number in (0, ticket.number):
            self._end(ticket, "the operator has declined", now)

    @property
    def shown(self) -> Ticket | None:
        """The proposal on the screens: what runs, else the oldest one."""
        return self._running or next(iter(self._tickets), None)

    @property
    def busy(self) -> bool:
        """Whether anything must be ended in time."""
        return bool(self._tickets) or self._stopping is not None

    def view(self, now: float) -> ProposalView | None:
        """Return what the screens show."""
        ticket = self.shown
        if ticket is None:
            return None
        proposal, contact = ticket.proposal, self._fleet.get(ticket.proposal.system)
        runs = ticket.stage is ProposalStage.RUNNING
        return ProposalView(
            number=ticket.number,
            who=proposal.who,
            text=proposal.text,
            reason=proposal.reason,
            vehicle="" if contact is None or self._is_selected(ticket) else contact.state.name,
            seconds=proposal.seconds,
            meters=proposal.meters,
            runs=runs,
            left=max(0.0, ticket.until - now),
            ran=now - ticket.began if runs else 0.0,
            covered=ticket.meters,
            waiting=len(self._tickets) - 1,
        )

    # ---- time ----

    def tick(self, now: float) -> None:
        """End what has waited or run for too long, and what nobody permits any more."""
        for ticket in list(self._tickets):
            if ticket.stage is ProposalStage.RUNNING:
                self._measure(ticket, now)
            if (why := self._fault(ticket, now)) is not None:
                self._end(ticket, why, now)
        stopping = self._stopping
        if stopping is not None and now >= stopping.due:
            stopping.due = now + HOLD_PERIOD
            if stopping.contact.state.drives_itself:
                self._commander.set_mode(stopping.contact.state, HOLD, now)
            if now >= stopping.until:
                self._stopping = None

    def _measure(self, ticket: Ticket, now: float) -> None:
        contact = self._fleet.get(ticket.proposal.system)
        speed = None if contact is None else contact.state.speed
        ticket.meters += abs(speed or 0.0) * max(0.0, now - self._measured_at)
        self._measured_at = now

    def _fault(self, ticket: Ticket, now: float) -> str | None:
        """Return why a proposal ends now."""
        if ticket.stage is ProposalStage.WAITING:
            if self.permitting_screen() is None:
                return NO_SCREEN
            return "nobody has held the key in time" if now >= ticket.until else None
        return next((why for why in self._faults(ticket, now) if why), None)

    def _faults(self, ticket: Ticket, now: float) -> Iterator[str | None]:
        """Yield what ends a proposal that runs; None or "" for what does not hold."""
        proposal, contact = ticket.proposal, self._fleet.get(ticket.proposal.system)
        yield None if now < ticket.until else "the key was released"
        yield self._operator.permission_blocked_reason(now)
        yield NO_SCREEN if self.permitting_screen() is None else None
        yield None if self._is_selected(ticket) else "another vehicle is selected"
        yield f"the agent was silent for {AGENT_SILENCE:g} s" if now - ticket.heard_at > AGENT_SILENCE else None
        yield f"{proposal.seconds:g} s are over" if now - ticket.began >= proposal.seconds else None
        if proposal.meters is not None and contact is not None:
            yield f"{proposal.meters:g} m are covered" if ticket.meters >= proposal.meters else None
            yield f"{contact.state.name} reports no speed" if contact.state.speed is None else None

    # ---- ends ----

    def _end(self, ticket: Ticket, why: str, now: float, *, done: bool = False) -> None:
        if ticket.stage is ProposalStage.ENDED:
            return
        ran = f" after {now - ticket.began:.1f} s" if ticket.stage is ProposalStage.RUNNING else ""
        if ticket.stage is ProposalStage.RUNNING:
            self._stop(ticket, now)
        self._tickets.remove(ticket)
        ticket.stage, ticket.why, ticket.done = ProposalStage.ENDED, why, done
        self._say(now, f"agent {ticket.number}: {'done' if done else 'ended'}{ran}: {why}", Severity.NOTICE)
        ticket.changed()

    def _stop(self, ticket: Ticket, now: float) -> None:
        """Stop what the vehicle does by itself. What a verb demands of it ends with neutral (running_verbs.py)."""
        contact = self._fleet.get(ticket.proposal.system)
        if contact is None:
            return
        self._stopping = _Stopping(contact, now + HOLD_AGAIN, now + HOLD_PERIOD)
        if contact.state.drives_itself:
            self._commander.set_mode(contact.state, HOLD, now)

    # ---- own ----

    @property
    def _running(self) -> Ticket | None:
        return next((each for each in self._tickets if each.stage is ProposalStage.RUNNING), None)

    def _refusal(self, proposal: Proposal) -> str | None:
        contact = self._fleet.get(proposal.system)
        if contact is not None and contact.state.model.flies:  # first: no screen and no wait changes it
            return f"{contact.state.name} flies: agents may only read it and stop it"
        if self.permitting_screen() is None:
            return NO_SCREEN
        if len(self._tickets) >= MOST_WAITING:
            return f"{MOST_WAITING} proposals wait already: wait for their end"
        if contact is None:
            return f"no vehicle {proposal.system} is heard"
        if proposal.meters is not None and contact.state.speed is None:
            return f"{contact.state.name} reports no speed: a distance cannot be bounded"
        return None

    def _is_selected(self, ticket: Ticket) -> bool:
        selected = self._fleet.selected
        return selected is not None and selected.state.system == ticket.proposal.system

    def _say(self, now: float, text: str, severity: Severity) -> None:
        self._log.add(now, "station", printable(text), severity)

    def _note(self, now: float, text: str) -> None:
        self.take_note(now, printable(text))


def _describe(intent: Intent) -> str:
    return f"the operator did something else ({type(intent).__name__})"
