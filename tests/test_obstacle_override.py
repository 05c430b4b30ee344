"""A sensor that sees a wall at 0 cm for ever, and the held key that overrides it: from the key to the motors."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, Stop
from groundstation.intents.session import ReportKeyReleases, SetKeyGate
from tests.test_stops import Drive
from vehicle.proximity.obstacles import OVERRIDE_SPEED
from vehicle.proximity.override import LONGEST
from vehicle.readings import Cone

OVERRIDE = DriveKeyDown("b", 0, 0, override=True)
SENT = 0.1
"""s until the next demand has come, and the motors have fallen from 0.2 m/s."""


class BeforeNothing(Drive):
    """A rover whose sensor begins to claim an obstacle right before it."""

    def __init__(self, style: str = "hold") -> None:
        super().__init__(style=style, session=7)
        self.claims = False

    def _each(self, now: float) -> None:
        if self.claims:
            self.rover._obstacles.hear("RNGFND1", "RNGFND1", (Cone(0.0, 0.2, 0.0, 4.0),), now)
        super()._each(now)

    @property
    def creep(self) -> float:
        return OVERRIDE_SPEED / float(self.params["SPEED_MAX"])

    @property
    def texts(self) -> str:
        return "\n".join(line.text for line in self.station.log.build_lines(self.world.now, 0.0))

    def overridden(self) -> None:
        """Drive, be stopped by the claim, and creep on by the key."""
        self.tell(ReportKeyReleases())
        self.get_going()
        self.claims = True
        self.until(lambda: self.power == 0.0, within=2.0)
        self.run(1.0)
        assert self.held
        assert self.power == 0.0
        self.tell(OVERRIDE)
        self.until(lambda: self.power > 0.5 * self.creep)
        self.moved.clear()
        self.run(0.5)
        assert min(power for _, power in self.moved) > 0.0
        assert max(power for _, power in self.moved) <= self.creep + 0.01
        assert self.station.snapshot(self.world.now, 0).operator.overrides


@pytest.mark.parametrize(
    ("end", "bound"),
    [
        (lambda drive: drive.tell(DriveKeyUp("b")), SENT),
        (lambda drive: drive.tell(Stop()), SENT),
        (lambda drive: drive.tell(SetKeyGate(False, "help is open")), SENT),
        (lambda drive: setattr(drive, "screen_lives", False), 0.5),
        (lambda drive: setattr(drive.world.near, "frozen", True), 0.5),
        (lambda drive: drive.world.cut(), 0.5),
    ],
    ids=["let go", "stop key", "other screen", "frozen screen", "killed", "link cut"],
)
def test_the_override_ends_with_its_key(end: Callable[[BeforeNothing], None], bound: float) -> None:
    drive = BeforeNothing()
    drive.overridden()
    end(drive)
    drive.until(lambda: drive.power == 0.0, within=bound + 0.02)
    drive.moved.clear()
    drive.run(2.0)
    assert max(power for _, power in drive.moved) == 0.0
    assert not drive.rover._obstacles.overridden


def test_both_ends_say_that_obstacles_are_overridden() -> None:
    drive = BeforeNothing()
    drive.overridden()
    drive.tell(DriveKeyUp("b"))
    drive.run(2.0)
    assert not drive.station.snapshot(drive.world.now, 0).operator.overrides
    assert "obstacles overridden, 0.2 m/s" in drive.texts
    assert "obstacles count again" in drive.texts


def test_a_taped_key_ends_and_latched_driving_needs_it_held() -> None:
    drive = BeforeNothing("latch")
    drive.overridden()
    drive.run(LONGEST)
    assert drive.power == 0.0
    drive.tell(DriveKeyUp("b"), OVERRIDE)
    drive.run(0.5)
    drive.tell(OVERRIDE, DriveKeyUp("b"))
    drive.until(lambda: drive.power == 0.0, within=SENT)


def test_the_key_alone_moves_nothing() -> None:
    drive = BeforeNothing()
    drive.tell(ReportKeyReleases())
    drive.get_going()
    drive.held = None
    drive.tell(DriveKeyUp("i"))
    drive.until(lambda: drive.power == 0.0)
    drive.tell(OVERRIDE)
    drive.moved.clear()
    drive.run(1.0)
    assert max(power for _, power in drive.moved) == 0.0


def test_without_key_releases_the_newest_key_holds_both() -> None:
    drive = BeforeNothing()
    drive.get_going()
    drive.claims = True
    drive.until(lambda: drive.power == 0.0, within=2.0)
    drive.tell(OVERRIDE)  # from here on the terminal sends repeats of the newer key only
    drive.until(lambda: drive.power > 0.5 * drive.creep)
    drive.run(1.0)
    assert drive.power > 0.0
    drive.held = None
    drive.until(lambda: drive.power == 0.0, within=1.0)
    assert not drive.station.snapshot(drive.world.now, 0).operator.overrides
