"""Proposals of agents: refused for what flies, and without a screen."""

from __future__ import annotations

import pytest

from groundstation.station.agents.proposals import NO_SCREEN, Proposal, Ticket
from tests.fakes.flying import FlyingVehicle
from tests.fakes.multicopters import ArduCopter, Px4Quad
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import cockpit_with

SCREENS = (None, "screen on pts/1")


@pytest.mark.parametrize("copter", [ArduCopter(), Px4Quad()], ids=["arducopter", "px4"])
def test_what_flies_gets_no_proposal(copter: FlyingVehicle) -> None:
    cockpit = cockpit_with(copter)
    cockpit.run(3.0)
    book = cockpit.station.proposals
    for screen in SCREENS:
        book.permitting_screen = lambda screen=screen: screen  # type: ignore[misc]
        why = book.propose(Proposal("agent", "arm", "go", copter.system, 5.0), cockpit.now)
        assert isinstance(why, str)
        assert "flies: agents may only read it and stop it" in why
    assert book.shown is None


def test_a_rover_gets_one_with_a_screen_only() -> None:
    rover = FakeVehicle()
    cockpit = cockpit_with(rover)
    cockpit.run(3.0)
    book, arm = cockpit.station.proposals, Proposal("agent", "arm", "go", rover.system, 5.0)
    book.permitting_screen = lambda: None
    assert book.propose(arm, cockpit.now) == NO_SCREEN
    book.permitting_screen = lambda: "screen on pts/1"
    assert isinstance(book.propose(arm, cockpit.now), Ticket)
