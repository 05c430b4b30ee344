"""Nothing is driven that neutral, HOLD and disarming do not stop: a helicopter is shown, and nothing moves it."""

from __future__ import annotations

import pytest

from dialects import messages as m
from dialects.enums import Command
from groundstation.geo import Place
from groundstation.intents.base import Intent
from groundstation.intents.driving import DrivePad, EmergencyStop, Stop
from groundstation.intents.plan import ChooseMode, GoTo, StartMission
from groundstation.intents.session import ReportKeyReleases
from groundstation.intents.vehicle import Arm, Disarm, RequestControl, SetMode
from groundstation.station.driving.stops.stop_questions import CONFIRM_AFTER, CONFIRM_WITHIN
from link.core import Peer, Received
from tests.fakes.copter import FORCED, HELICOPTER, FakeCopter
from tests.fakes.vehicle import FakeVehicle
from tests.groundstation.cockpits import FORWARD, Cockpit, cockpit_with

WHY = "keys do not drive a helicopter: a released key lets it fall"
OTHER_KINDS = [
    (3, HELICOPTER),
    (12, HELICOPTER),
    (0, HELICOPTER),
    (3, 1),
    (3, 12),
    (3, 0),
    (0, 0),
    (3, 20),
    (3, 46),
    (5, 10),
]


def sent(copter: FakeCopter, command: int) -> list[m.CommandLong]:
    return copter.commands(command)


def heard(message: m.Message) -> Received:
    """Return a message of a program that does not look at the kind of vehicle."""
    return Received(message, 255, 190, 0, Peer(0, "other"), introduced=True)


def demands(copter: FakeVehicle) -> list[m.Message]:
    kinds = (m.ManualControl, m.RcChannelsOverride, m.RoverOperatorPresence)
    return [message for _, message in copter.received if isinstance(message, kinds)]


def test_the_stand_in_climbs_and_falls_as_it_was_measured() -> None:
    copter = FakeCopter()
    cockpit = cockpit_with(copter)
    copter.armed = True
    for _ in range(60):
        copter.receive(heard(m.ManualControl(1, 0, 0, 600, 0, 0)), cockpit.now)
        cockpit.run(0.05)
    assert 5.0 < copter.highest < 6.0
    copter.receive(heard(m.ManualControl(1, 0, 0, 0, 0, 0)), cockpit.now)
    cockpit.run(3.0)
    assert copter.hit_ground_at > 5.0


@pytest.mark.parametrize(("autopilot", "kind"), OTHER_KINDS)
def test_no_key_arms_or_moves_another_kind(autopilot: int, kind: int) -> None:
    copter = FakeCopter(autopilot=autopilot, kind=kind)
    cockpit = cockpit_with(copter)
    copter.armed = True  # somebody else has armed it
    cockpit.run(1.5)
    pad = DrivePad(throttle=1.0, steering=0.0, read_at=cockpit.now)
    for intent in (ReportKeyReleases(), RequestControl(), Arm(held=1.0), SetMode(mode="MANUAL"), SetMode(mode="HOLD"),
                   FORWARD, pad, Stop()):  # fmt: skip
        cockpit.do(intent)
        cockpit.run(1.0)
    assert demands(copter) == []
    assert copter.highest == 0.0
    assert sent(copter, Command.DO_SET_MODE) == []
    assert [each.param1 for each in sent(copter, Command.COMPONENT_ARM_DISARM)] == []
    assert cockpit.view.undriven
    assert cockpit.operator.gate_reason == cockpit.view.undriven
    assert not cockpit.view.in_control


@pytest.mark.parametrize(
    ("intent", "text"),
    [
        (Arm(held=1.0), "arm: ArduPilot helicopter 1: "),
        (SetMode(mode="HOLD"), "mode HOLD: ArduPilot helicopter 1: "),
        (SetMode(mode="MANUAL"), "mode MANUAL: ArduPilot helicopter 1: "),
        (RequestControl(), "request control: ArduPilot helicopter 1: "),
    ],
    ids=["arm", "hold", "manual", "control"],
)
def test_one_line_says_why(intent: Intent, text: str) -> None:
    cockpit = cockpit_with(FakeCopter())
    cockpit.do(intent)
    cockpit.run(0.5)
    assert [line for line in cockpit.texts if WHY in line] == [text + WHY]


def test_the_last_look_before_the_link_refuses_on_its_own() -> None:
    """Whatever a front end overlooks: the station asks for each message that it is about to send."""
    copter = FakeCopter()
    cockpit = cockpit_with(copter)
    to = (1, 1)
    refused = [
        m.ManualControl(1, 0, 0, 600, 0, 0),
        m.RcChannelsOverride(*to, *[1500] * 8),
        m.SetPositionTargetLocalNed(0, *to, 1, 0, *[0.0] * 11),
        m.SetAttitudeTarget(0, *to, 0, [1.0, 0.0, 0.0, 0.0], 0.0, 0.0, 0.0, 0.6),
        m.SetMode(1, 1, 4),
        m.CommandLong(*to, Command.COMPONENT_ARM_DISARM, 0, 1, 0, 0, 0, 0, 0, 0),
        m.CommandLong(*to, Command.DO_SET_MODE, 0, 1, 4, 0, 0, 0, 0, 0),
        m.CommandLong(*to, Command.MISSION_START, 0, 0, 0, 0, 0, 0, 0, 0),
        m.CommandLong(*to, Command.DO_MOTOR_TEST, 0, 1, 0, 10, 1, 1, 0, 0),
        m.CommandInt(*to, 6, Command.DO_REPOSITION, 0, 0, -1, 1, 0, 0, 1, 1, 0),
        m.MissionItemInt(*to, 0, 3, 16, 2, 1, 0, 0, 0, 0, 1, 1, 0),
        m.ManualControl(0, 0, 0, 600, 0, 0),
        m.CommandLong(0, 0, Command.DO_SET_MODE, 0, 1, 4, 0, 0, 0, 0, 0),
        m.ManualControl(7, 0, 0, 600, 0, 0),
    ]
    passed = [
        m.CommandLong(*to, Command.COMPONENT_ARM_DISARM, 0, 0, 0, 0, 0, 0, 0, 0),
        m.CommandLong(*to, Command.COMPONENT_ARM_DISARM, 0, 0, FORCED, 0, 0, 0, 0, 0),
        m.CommandLong(0, 0, Command.COMPONENT_ARM_DISARM, 0, 0, 0, 0, 0, 0, 0, 0),
        m.CommandLong(*to, Command.DO_SET_SAFETY_SWITCH_STATE, 0, 0, 0, 0, 0, 0, 0, 0),
        m.CommandLong(*to, Command.NAV_RETURN_TO_LAUNCH, 0, 0, 0, 0, 0, 0, 0, 0),
        m.CommandLong(*to, Command.REQUEST_MESSAGE, 0, 435, 0, 0, 0, 0, 0, 0),
        m.ParamRequestRead(*to, b"ARMING_CHECK", -1),
    ]
    assert [cockpit.station.may_send(message, cockpit.now) for message in refused] == [False] * len(refused)
    assert [cockpit.station.may_send(message, cockpit.now) for message in passed] == [True] * len(passed)


@pytest.mark.parametrize("intent", [StartMission(1, 1), GoTo(1, 1, place=Place(47.0, 8.0))], ids=["mission", "go to"])
def test_no_request_starts_a_motion(intent: Intent) -> None:
    copter = FakeCopter()
    cockpit = cockpit_with(copter)
    cockpit.do(intent)
    cockpit.run(3.0)
    moving = (Command.DO_SET_MODE, Command.MISSION_START, Command.DO_REPOSITION)
    received = [each for _, each in copter.received if isinstance(each, m.CommandLong | m.CommandInt)]
    assert [each for each in received if each.command in moving] == []
    assert any(WHY in text for text in cockpit.texts)


def test_a_mode_that_it_lists_is_sent_by_its_own_number() -> None:
    copter = FakeCopter()
    cockpit = cockpit_with(copter)
    cockpit.do(ChooseMode(1, 1, mode="LAND"))
    cockpit.run(3.0)
    assert copter.mode == 9
    assert cockpit.view.mode == "LAND"
    cockpit.do(ChooseMode(2, 1, mode="HOLD"))
    cockpit.run(3.0)
    assert copter.mode == 9, "4 is GUIDED there"


def test_without_a_list_no_mode_is_sent_by_number() -> None:
    copter = FakeCopter(lists=False)
    cockpit = cockpit_with(copter)
    cockpit.do(ChooseMode(1, 1, mode="LAND"))
    cockpit.run(8.0)
    assert sent(copter, Command.DO_SET_MODE) == []
    assert any(f"{WHY}, and it lists no modes itself" in text for text in cockpit.texts)


class TestStops:
    def test_disarm_passes(self) -> None:
        copter = FakeCopter()
        copter.armed = True
        cockpit = cockpit_with(copter)
        cockpit.do(Disarm())
        cockpit.run(2.0)
        assert not copter.armed

    def test_the_emergency_stop_of_one_in_the_air_asks_first(self) -> None:
        copter, cockpit = flying()
        cockpit.do(EmergencyStop())
        cockpit.run(0.5)
        assert copter.altitude == pytest.approx(20.0)
        assert cockpit.view.stop_question == pytest.approx(CONFIRM_WITHIN - 0.5, abs=0.1)
        assert any("falls without power" in text for text in cockpit.texts)
        cockpit.run(CONFIRM_AFTER)
        cockpit.do(EmergencyStop())
        cockpit.run(3.0)
        assert not copter.armed
        assert copter.altitude == 0.0
        assert cockpit.view.stop_question is None

    def test_a_held_key_is_no_answer(self) -> None:
        copter, cockpit = flying()
        for _ in range(100):
            cockpit.do(EmergencyStop())
            cockpit.run(0.04)
        assert copter.armed
        assert copter.altitude == pytest.approx(20.0)

    def test_a_late_answer_asks_again(self) -> None:
        copter, cockpit = flying()
        cockpit.do(EmergencyStop())
        cockpit.run(CONFIRM_WITHIN + 0.5)
        assert cockpit.view.stop_question is None
        cockpit.do(EmergencyStop())
        cockpit.run(1.0)
        assert copter.armed

    def test_disarmed_or_on_the_ground_it_does_not_ask(self) -> None:
        copter = FakeCopter()
        copter.armed = True
        cockpit = cockpit_with(copter)
        copter.send(m.ExtendedSysState(0, 1))
        cockpit.run(0.2)
        cockpit.do(EmergencyStop())
        cockpit.run(1.0)
        assert not copter.armed

    def test_stop_sends_no_mode_by_number(self) -> None:
        copter, cockpit = flying()
        cockpit.do(Stop())
        cockpit.run(2.0)
        assert copter.mode == 5


def flying() -> tuple[FakeCopter, Cockpit]:
    copter = FakeCopter()
    cockpit = cockpit_with(copter)
    copter.lift(20.0)
    cockpit.run(1.0)
    assert cockpit.view.may_fall
    assert copter.altitude == pytest.approx(20.0)
    return copter, cockpit
