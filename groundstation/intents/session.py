"""Intents of the session of a screen: its keys, its lease, what it watches, its end."""

from __future__ import annotations

from groundstation.intents.base import Intent

LEASE_TIMEOUT = 0.3
"""s without a renewal after which the screen counts as frozen: three renewals at its 10 Hz, and longer than its longest
drawing (0.1 s). A frozen screen then means neutral well within 0.5 s."""


REST_PERIOD = 0.25
"""s between renewals, and between ticks of the station and its reports to the watchdog, while the station rests: no
vehicle is armed, nothing is under way. All come at the multiples of it, because to wake a process costs more than what
it does then."""

REST_LEASE_TIMEOUT = 1.0
"""s, as LEASE_TIMEOUT, while the station rests."""


class ReportKeyReleases(Intent, frozen=True):
    """The terminal has proved that it reports key releases: no timers are needed any more."""

    is_input = False
    valid_when_late = True
    reports: bool = True
    """False: a key has come for which it reports none, and timers are needed again."""


QUITTING, SUSPENDED = "quitting", "the ground station was suspended"
"""Beginnings of the reasons of an operator who leaves the screen: its lease runs out, and nothing is wrong."""


class SetKeyGate(Intent, frozen=True):
    """Open or close the key gate. It is closed under another screen, without focus and without a terminal."""

    is_input = False
    valid_when_late = True
    open: bool
    reason: str = ""
    permits: bool = False
    """Closed only for another screen that shows what agents propose: the key that permits it counts there, too."""


class RenewLease(Intent, frozen=True):
    """The screen's event loop runs. Without renewals the station sends neutral, then nothing."""

    is_input = False


class ReportScreen(Intent, frozen=True):
    """Another screen came up. The station only notes it in the telemetry log."""

    is_input = False
    valid_when_late = True
    screen: str
    """Its id."""


class StartSimulator(Intent, frozen=True):
    """Start simulated rovers as children of the station process and let them connect to us."""

    log_text = "start the simulator"
    kind: str = "rover"
    """A row of groundstation.sitl.simulators.SIMULATORS."""


class GiveUpKeys(Intent, frozen=True):
    """Neutral, and this screen drives no more; without another one that asks, a program may drive then."""


class Detach(Intent, frozen=True):
    """The screen ends in order, but its operator did not quit: a station that is kept goes on, neutral."""

    is_input = False
    valid_when_late = True


class Quit(Intent, frozen=True):
    """Send neutral several times and exit."""

    is_input = False
    valid_when_late = True
    disarm: bool = False
    """Disarm before the exit what this station armed; another Quit without it meanwhile leaves that armed."""

    def describe(self) -> str:
        return "quit, disarm first" if self.disarm else "quit"
