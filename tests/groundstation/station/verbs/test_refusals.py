"""A certificate that may watch only: what it does not allow is refused at once, with the role that is missing."""

from __future__ import annotations

from collections.abc import Hashable

import pytest

from dialects import messages as m
from dialects.enums import Command
from groundstation.intents.driving import EmergencyStop
from groundstation.intents.plan import ClearPlan
from groundstation.intents.vehicle import Arm, Disarm
from groundstation.station.verbs.running_verbs import VerbMessage
from groundstation.views.requests import RequestsRequest
from link.fleet.keys import read_frame
from link.fleet.roles import needed_role
from link.signing.role import SigningRole
from tests.fakes.vehicle import QUERIES, FakeVehicle
from tests.fakes.verb_seat import SeatLog, verb_of
from tests.groundstation.cockpits import Cockpit
from tests.world import Host

WHY = "the certificate of bob may watch only; ask for the role drive"


class RoleHost(Host):
    """Drives the station as the runner does with a link that knows roles."""

    def pop_frames(self, now: float, to: Hashable) -> list[bytes]:
        frames: list[bytes] = []
        for outgoing in self.core.messages_to_send():
            for data, _, sequence in self.channel.send(outgoing, now=now):
                frame = read_frame(data)
                assert frame is not None
                if needed_role(frame) > SigningRole.WATCH:
                    self.core.handle_refused(outgoing.message, WHY, now)  # type: ignore[attr-defined]
                    continue
                frames.append(data)
                assert self.listener is not None
                self.listener.handle_sent(outgoing.message, sequence, now)
        return frames


@pytest.fixture
def cockpit() -> Cockpit:
    cockpit = Cockpit(FakeVehicle())
    near = cockpit.world.near
    cockpit.world.near = RoleHost(near.core, near.channel, near.period)
    cockpit.run(2.0)
    assert cockpit.view.alive
    return cockpit


def commands(cockpit: Cockpit) -> list[int]:
    return [each.command for _, each in cockpit.vehicle.all(m.CommandLong) if each.command not in QUERIES]


def test_arming_says_at_once_which_role_is_missing(cockpit: Cockpit) -> None:
    assert not any("not sent" in text for text in cockpit.texts), "what the station sends by itself is not reported"
    cockpit.do(Arm(held=1.0))
    cockpit.run(0.3)
    assert cockpit.view.refusal == f"arm: {WHY}"
    assert commands(cockpit) == []
    cockpit.run(3.0)
    assert not cockpit.view.armed
    assert cockpit.texts.count(f"arm: {WHY}") == 1, "nothing is repeated"


def test_stops_are_sent(cockpit: Cockpit) -> None:
    cockpit.vehicle.armed = True
    cockpit.run(1.5)
    cockpit.do(Disarm())
    cockpit.run(1.0)
    assert not cockpit.vehicle.armed
    cockpit.do(EmergencyStop())
    cockpit.run(0.5)
    assert Command.DO_SET_SAFETY_SWITCH_STATE in commands(cockpit)


def test_a_request_ends_as_refused(cockpit: Cockpit) -> None:
    cockpit.do(ClearPlan(request=1))
    cockpit.run(5.0)
    view = cockpit.station.services.build_requests(RequestsRequest(), cockpit.now, cockpit.now)
    assert [(line.state, line.detail) for line in view.ended] == [("refused", WHY)]
    assert f"Rover 1: not sent: {WHY}" in cockpit.texts


def test_a_verb_is_told_of_its_own_messages_only(cockpit: Cockpit) -> None:
    told, verbs = (seat := SeatLog()).refused, cockpit.station.verbs
    verb = verb_of("arm", needs_session=True, seat=seat)
    verbs.join(verb, cockpit.now)
    arm = m.CommandLong(1, 1, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0)
    verbs.handle(verb, VerbMessage(arm), cockpit.now)
    cockpit.world.settle()
    assert told == [(arm, WHY)]
    cockpit.do(Arm(held=1.0))
    cockpit.run(1.0)
    assert len(told) == 1
