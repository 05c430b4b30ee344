"""The monkey of tests/test_stop_monkey.py under the rules of this package, with a screen that looks at its station."""

from __future__ import annotations

from dialects.messages import RoverDriveStatus
from groundstation.views.doctor import DoctorRequest
from groundstation.views.drive import SpeedRequest, TrackRequest
from groundstation.views.links import ControlRequest, LinksRequest, VehiclesRequest
from groundstation.views.log import LogRequest
from groundstation.views.messages import MessagesRequest
from tests.soak.rules import OBEYED, RAMP
from tests.test_stop_monkey import SLACK, Monkey
from vehicle.safety.states import SafetyState

STEP = 0.01
"""s of virtual time between two looks at everything."""
LOOKS = 1.0
"""s between two snapshots for the screen."""
WATCHED = (
    LogRequest(),
    MessagesRequest(),
    LinksRequest(),
    VehiclesRequest(),
    ControlRequest(),
    DoctorRequest(),
    TrackRequest(),
    SpeedRequest(),
)
"""Views that the screen asks for, one after the other; with a change of view the station sends the whole view again."""
SESSION = 1479
"""The station proves the age of its demands, as the program does."""
RESOLUTION = 0.001
"""s: the vehicle's time that a demand echoes is in ms."""


class StrictMonkey(Monkey):
    """Checks the rules of rules.py at each step, and looks at the station once a second."""

    def __init__(self, style: str) -> None:
        self.oldest_obeyed = 0.0
        """s; largest age of a demand of motion that the vehicle has reported as obeyed (ROVER_DRIVE_STATUS), counted
        from its arrival."""
        self.oldest_sent = 0.0
        """s; the same, counted from its sending."""
        self._before = 0.0
        self._reports = 0
        self._waiters = 0
        super().__init__(style, SESSION)
        self.world.step = STEP

    def forget(self) -> None:
        """Forget what was sent so far, and charge the battery, which lasts for 2.4 hours."""
        super().forget()
        self.battery.remaining = 1.0
        self._reports = 0

    def _each(self, now: float) -> None:
        super()._each(now)
        power, age = self.power, now - self.last_demand
        if power:
            assert self.rover.state is SafetyState.ARMED, f"power {power:.2f} while {self.rover.state.name}"
            assert age <= OBEYED + RAMP + SLACK, f"power {age:.3f} s after the newest demand of motion was sent"
        if power > self._before:
            assert age <= OBEYED + SLACK, f"power rose by a demand of {age:.3f} s"
        self._before = power
        self._check_reports()
        if now >= self._waiters * LOOKS and not self.world.near.frozen:
            self._look(now)

    def _check_reports(self) -> None:
        sent, sent_at = self.world.far.sent, self.world.near.sent_at
        for at, message in sent[self._reports :]:
            if isinstance(message, RoverDriveStatus) and (message.demand_throttle or message.demand_steering):
                self.oldest_obeyed = max(self.oldest_obeyed, message.demand_age_ms / 1000)
                self.oldest_sent = max(self.oldest_sent, at - sent_at[message.source_seq])
        self._reports = len(sent)
        assert self.oldest_obeyed <= OBEYED, f"a demand was obeyed {self.oldest_obeyed:.3f} s after it arrived"
        assert self.oldest_sent <= OBEYED + RESOLUTION, (
            f"a demand was obeyed {self.oldest_sent:.3f} s after it was sent"
        )

    def _look(self, now: float) -> None:
        """Do what the station process does for its screen."""
        self._waiters = int(now / LOOKS) + 1
        self.station.snapshot(now, now)
        self.station.views.watch([WATCHED[self._waiters % len(WATCHED)]])
        self.station.views.send_due(lambda view: True, now, now)
