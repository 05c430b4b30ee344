"""Which of several screens drives: one holds the lease, the others look, stop, and may ask for it. Time is an argument.

The lease decides only whose keys count. That they are fresh is checked as with one screen: the holder renews it, and
without a renewal for LEASE_TIMEOUT the station is neutral (operator.py). It never goes to another screen unasked.
"""

from __future__ import annotations

import msgspec

from dialects.enums import Severity
from dialects.mode_tables import HOLD
from groundstation.intents.base import Intent
from groundstation.intents.driving import STOP_KEY, DriveKeyDown, DriveKeyUp, DrivePad, ReleasePad, Stop
from groundstation.intents.session import GiveUpKeys, RenewLease, ReportKeyReleases, SetKeyGate
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import GiveControl, KeepControl, RequestControl, SetMode
from groundstation.snapshot.lease import NO_SCREEN, LeaseView
from groundstation.station.driving.driving import DrivingController
from groundstation.station.driving.operator import OperatorSession
from groundstation.vehicles.state.message_log import MessageLog

ANSWER_WITHIN = 10.0
"""s for the holder to answer, as for another ground station."""

DEAD_AFTER = 3.0
"""s without a renewal after which the holder is not asked: its process stands still, or its machine is too busy."""

NUMBERS = 1_000_000
"""Numbers of requests for each screen."""

NOBODY = "no screen drives: neutral"

_DRIVES = DriveKeyDown | DriveKeyUp | DrivePad | ReleasePad
"""What a watcher sends all the time, and is refused without a line for each."""

_CLOSED = SetKeyGate(open=False, reason="starting")


class Screen(msgspec.Struct, eq=False):
    """One screen. `number` counts those of this station from 0."""

    number: int
    name: str
    gate: SetKeyGate = _CLOSED
    """Its newest."""
    reports_releases: bool = False
    renewed_at: float = 0.0

    @property
    def first_request(self) -> int:
        """The number of its first request; no other screen uses it or those that follow."""
        return self.number * NUMBERS + 1


class _Asked(msgspec.Struct):
    screen: Screen
    until: float


class ScreenLease(msgspec.Struct):
    """The screens of one station."""

    operator: OperatorSession
    driving: DrivingController
    log: MessageLog
    holder: Screen | None = None
    _gave_up: Screen | None = None
    """The screen that has given up the keys, while nobody has them."""
    _asked: _Asked | None = None
    _count: int = 0

    def join(self, name: str, now: float, *, watches: bool = False) -> Screen:
        """Add a screen; it drives if no other one does, unless it only `watches` at first."""
        screen = Screen(self._count, name, renewed_at=now)
        self._count += 1
        if self.holder is not None or watches:
            return screen
        if screen.number == 0:
            self.holder = screen  # there are no keys of another
        else:
            self._pass_to(screen, now)
        return screen

    def leave(self, screen: Screen, now: float) -> bool:
        """Forget a screen that has ended. Returns True if it drove: neutral, and nobody drives."""
        if self._asked is not None and self._asked.screen is screen:
            self._asked = None
        if screen is self._gave_up:
            self._gave_up = None
        if screen is not self.holder:
            return False
        self._pass_to(self._waiting, now)
        return True

    def is_last_driver(self, screen: Screen) -> bool:
        """Return whether a screen has the keys, or gave them up and nobody has taken them since."""
        return screen is (self.holder or self._gave_up)

    def filter(self, screen: Screen, intent: AnyIntent, now: float) -> AnyIntent | None:
        """Return the intent if the station carries it out; None if not, or if it was for the lease itself."""
        match intent:
            case RenewLease():
                screen.renewed_at = now
            case SetKeyGate():
                screen.gate = intent
            case ReportKeyReleases(reports=reports):
                screen.reports_releases = reports
        if screen is self.holder:
            if isinstance(intent, GiveUpKeys):
                self._give_up(screen, now)
                return None
            return None if self._answers(intent, now) else intent
        return intent if self._may_watcher(screen, intent, now) else None

    def tick(self, now: float) -> None:
        """Let a request end: the holder keeps the lease, unless its keys do not drive anyway."""
        asked, holder = self._asked, self.holder
        if asked is None or holder is None:
            return
        if now - holder.renewed_at > DEAD_AFTER or (now >= asked.until and not holder.gate.open):
            self._pass_to(asked.screen, now)
        elif now >= asked.until:
            self._keep(now)

    def view(self, screen: Screen, now: float) -> LeaseView:
        """Return what a screen shows of the lease."""
        asked = self._asked
        if screen is not self.holder:
            waits = max(0.0, asked.until - now) if asked is not None and asked.screen is screen else None
            return LeaseView(driver=self.holder.name if self.holder else NO_SCREEN, waits=waits)
        return LeaseView() if asked is None else LeaseView(asks=asked.screen.name, left=max(0.0, asked.until - now))

    @property
    def _waiting(self) -> Screen | None:
        return None if self._asked is None else self._asked.screen

    def _give_up(self, screen: Screen, now: float) -> None:
        """Pass the keys to the screen that asks for them; without one no screen drives, and programs may."""
        self._pass_to(self._waiting, now)
        self._gave_up = screen if self.holder is None else None

    def _answers(self, intent: AnyIntent, now: float) -> bool:
        """Handle the holder's answer. Returns False without a request: then it is for another ground station."""
        if self._asked is None or not isinstance(intent, GiveControl | KeepControl):
            return False
        if isinstance(intent, GiveControl):
            self._pass_to(self._asked.screen, now)
        else:
            self._keep(now)
        return True

    def _may_watcher(self, screen: Screen, intent: Intent, now: float) -> bool:
        if isinstance(intent, RequestControl):
            self._ask(screen, now)
            return False
        if isinstance(intent, Stop):
            if intent.reason == STOP_KEY:
                self.operator.sticks.block(now)  # the holder's keys must be released before they drive again
            return intent.reason == STOP_KEY  # the other reasons only close the gate of that screen
        if intent.open_to_all or (isinstance(intent, SetMode) and intent.mode == HOLD):
            return True
        if intent.is_input and not isinstance(intent, _DRIVES):
            text = f"{type(intent).__name__} of the {screen.name} refused: it does not drive"
            self.log.add(now, "station", text, Severity.NOTICE)
        return False

    def _ask(self, screen: Screen, now: float) -> None:
        if self.holder is None:
            self._pass_to(screen, now)
        elif self._asked is None:
            self._asked = _Asked(screen, now + ANSWER_WITHIN)
            self.log.add(now, "station", f"the {screen.name} asks to drive", Severity.WARNING)
            self.tick(now)

    def _keep(self, now: float) -> None:
        asked, self._asked = self._asked, None
        if asked is not None:
            self.log.add(now, "station", f"the {asked.screen.name} does not get the keys", Severity.NOTICE)

    def _pass_to(self, screen: Screen | None, now: float) -> None:
        """Change the holder: neutral, and no key that is held anywhere counts."""
        self.holder, self._asked, self._gave_up = screen, None, None
        new = screen or Screen(-1, "")
        self.operator.change_screen(new.gate, now, reports_releases=new.reports_releases)
        self.driving.drop_demands()
        self.driving.update(self.driving.judge(now), now)
        text, severity = (f"the {new.name} drives", Severity.NOTICE) if screen else (NOBODY, Severity.WARNING)
        self.log.add(now, "station", text, severity)
