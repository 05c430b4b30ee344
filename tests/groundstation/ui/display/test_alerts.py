"""Which line a driver reads first."""

from __future__ import annotations

import math
from typing import Any

import pytest

from groundstation.actions import ACTIONS
from groundstation.input.hold_to_confirm import HoldProgress
from groundstation.snapshot import EmergencyProgress, HandoverNotice, LinkView, RecordingView, Snapshot
from groundstation.snapshot.lease import LeaseView
from groundstation.ui.display.alerts import LIMITS, AlertLevel, active_alerts
from groundstation.ui.display.display_state import DisplayState, ScreenInfo
from groundstation.ui.display.hints import hint
from groundstation.ui.keys.key_gate import OTHER_SCREEN, TEXT_FIELD, GateClosure
from tests.groundstation.ui.examples import helm, snapshot, vehicle, waiting
from tests.groundstation.ui.ptys import STANDARD

PROBLEM = LinkView(name="udp", problem="messages arrive with another dialect's checksum: HEARTBEAT")

ASKED = HandoverNotice(254, "Rover 1", 7.6)
OTHER = {"in_control": False, "driver": 254}

CASES: list[tuple[Snapshot, dict[str, Any], AlertLevel, str]] = [
    (snapshot(), {"outage": "station not responding: x"}, AlertLevel.DANGER, "station not responding: x"),
    (snapshot(), {"outage": "y", "station_alive": False}, AlertLevel.DANGER, "y; ^q quits"),
    (
        snapshot(lease=LeaseView(asks="screen on pts/4", left=8.2)),
        {},
        AlertLevel.QUESTION,
        "screen on pts/4 asks to drive: Y",
    ),
    (
        snapshot(lease=LeaseView(driver="screen on pts/4")),
        {},
        AlertLevel.WARNING,
        "you watch: screen on pts/4 drives; g asks",
    ),
    (
        snapshot(lease=LeaseView(driver="no screen")),
        {},
        AlertLevel.WARNING,
        "you watch: no screen drives, a program may; g takes the keys, stops work",
    ),
    (snapshot(lease=LeaseView(driver="x", waits=7.9)), {}, AlertLevel.WARNING, "x drives; asked (8 s), stops work"),
    (snapshot(handover=ASKED), {}, AlertLevel.QUESTION, "control of Rover 1: Y gives, N keeps (8 s)"),
    (
        snapshot(vehicle=vehicle(**OTHER, control_wait=6.0)),
        {},
        AlertLevel.WARNING,
        "drives: control requested, 6 s",
    ),
    (snapshot(vehicle=vehicle(**OTHER)), {"away": 9.0}, AlertLevel.WARNING, "tmux was detached for 9 s, control was"),
    (snapshot(operator=helm(ignored="a")), {}, AlertLevel.WARNING, "key ignored (a): release it, then press again"),
    (snapshot(vehicle=vehicle(status=5)), {}, AlertLevel.DANGER, "Rover 1 reports CRITICAL (a failsafe or fault)"),
    (snapshot(vehicle=vehicle(status=5, armed=False)), {}, AlertLevel.WARNING, "Rover 1 reports CRITICAL (a fail"),
    (
        snapshot(vehicle=vehicle(breach="outside the fence", mode="HOLD", drivable=False)),
        {},
        AlertLevel.DANGER,
        "Rover 1 is outside the fence (HOLD): drive it back, 1 changes to MANUAL",
    ),
    (snapshot(vehicle=vehicle(breach="outside the fence", armed=False)), {}, AlertLevel.WARNING, "outside the fence"),
    (snapshot(vehicle=vehicle(status=6)), {}, AlertLevel.DANGER, "Rover 1 reports EMERGENCY: see the log"),
    (snapshot(vehicle=vehicle(status=5, failsafes=("a",))), {}, AlertLevel.DANGER, "failsafe: a"),
    (
        snapshot(vehicles=tuple(range(1, 17)), not_shown=4),
        {},
        AlertLevel.WARNING,
        "4 more vehicles are not shown: the limit is 16",
    ),
    (
        snapshot(vehicles=tuple(range(1, 17)), not_shown=1),
        {},
        AlertLevel.WARNING,
        "1 more vehicle is not shown: the limit is 16",
    ),
    (snapshot(vehicle=vehicle(limits=("slew", "neutral first"))), {}, AlertLevel.WARNING, "neutral first: release"),
    (snapshot(recording=RecordingView(problem="not recording: disk full")), {}, AlertLevel.WARNING, "not recording: d"),
    (
        snapshot(vehicle=vehicle(stop_question=3.2)),
        {},
        AlertLevel.QUESTION,
        "Rover 1 is in the air and falls without power: ! again cuts it (3 s)",
    ),
    (snapshot(vehicle=vehicle(limits=("stale",))), {}, AlertLevel.WARNING, "stale: the vehicle has no recent command"),
    (
        snapshot(vehicle=vehicle(refusal="arm denied: PreArm: battery low")),
        {},
        AlertLevel.WARNING,
        "PreArm: battery low",
    ),
    (snapshot(vehicle=vehicle(failsafes=("gcs loss",))), {}, AlertLevel.DANGER, "failsafe: gcs loss"),
    (snapshot(vehicle=vehicle(failsafes=("a",), failsafe_in=3.4)), {}, AlertLevel.DANGER, "next step in 3 s"),
    (
        snapshot(vehicle=vehicle(alive=False, silence=4.0, link_loss_action="it stops by itself")),
        {},
        AlertLevel.DANGER,
        "no heartbeat from Rover 1 for 4 s: it stops by itself",
    ),
    (
        snapshot(vehicle=vehicle(alive=False, silence=math.inf, link_loss_action="it stops by itself")),
        {},
        AlertLevel.DANGER,
        "for minutes: it stops by itself",
    ),
    (
        snapshot(vehicle=vehicle(autopilot=3, name="ArduPilot rover 1", alive=False, silence=4.0)),
        {},
        AlertLevel.DANGER,
        "no heartbeat from ArduPilot rover 1 for 4 s: not known whether it stops",
    ),
    (snapshot(vehicle=vehicle(driver=None, alive=False)), {}, AlertLevel.DANGER, "s: not known whether it stops"),
    (snapshot(vehicle=vehicle(driver=255, alive=False)), {}, AlertLevel.DANGER, "s: not known whether it stops"),
    (
        snapshot(vehicle=vehicle(emergency_stop=True, armed=False)),
        {},
        AlertLevel.DANGER,
        "EMERGENCY STOP: the motors are off",
    ),
    (
        snapshot(vehicle=vehicle(in_control=False, driver=254)),
        {},
        AlertLevel.WARNING,
        "ground station 254 drives: g requests control",
    ),
    (
        snapshot(vehicle=vehicle(in_control=False, driver=255, duplicate_gcs=True), free_id=253),
        {},
        AlertLevel.WARNING,
        "another program with our id 255 drives: start with --system 253",
    ),
    (
        snapshot(vehicle=vehicle(in_control=False, driver=None)),
        {},
        AlertLevel.WARNING,
        "you are not in control: g requests control",
    ),
    (snapshot(vehicle=vehicle(warnings=("FS_GCS_ENABLE is 0",))), {}, AlertLevel.WARNING, "FS_GCS_ENABLE is 0"),
    (
        snapshot(id_conflict="ground station 255/230 uses our system id: start with --system 254"),
        {},
        AlertLevel.WARNING,
        "ground station 255/230 uses our system id: start with --system 254",
    ),
    (
        snapshot(
            vehicle=vehicle(obeys="obeys ground station 250 only", warnings=("x",), refusal="y", limits=("stale",))
        ),
        {},
        AlertLevel.WARNING,
        "obeys ground station 250 only",
    ),
    (snapshot(operator=helm(held_over=True)), {}, AlertLevel.WARNING, "one is held from before; release it"),
    (snapshot(links=(PROBLEM,)), {}, AlertLevel.WARNING, "udp: messages arrive with another"),
    (snapshot(operator=helm(style="latch")), {}, AlertLevel.WARNING, "the vehicle keeps driving: k or SPACE stops"),
    (
        snapshot(operator=helm(gate_open=False, gate_reason="screen was frozen")),
        {},
        AlertLevel.WARNING,
        "was frozen",
    ),
    (
        snapshot(),
        {"closure": GateClosure("the terminal does not answer")},
        AlertLevel.WARNING,
        "the terminal does not answer",
    ),
    (
        snapshot(),
        {"hold": HoldProgress(ACTIONS["vehicle.arm"], "r", 0.4)},
        AlertLevel.QUESTION,
        "Arm: hold r ████░░░░░░ 0.4 s",
    ),
    (snapshot(), {"station_alive": False}, AlertLevel.DANGER, "station process ended"),
]


@pytest.mark.parametrize(("picture", "more", "level", "words"), CASES, ids=[case[3] for case in CASES])
def test_what_is_said(picture: Snapshot, more: dict[str, Any], level: AlertLevel, words: str) -> None:
    first = active_alerts(DisplayState(picture, STANDARD, **more))[0]
    assert words in first.text
    assert first.level is level


EMERGENCY = [
    (None, True, "EMERGENCY STOP on, but the vehicle reports ARMED"),
    (EmergencyProgress.SENT, True, "EMERGENCY STOP sent, waiting for an answer, but the vehicle"),
    (EmergencyProgress.UNANSWERED, True, "EMERGENCY STOP sent, NOT acknowledged, but the vehicle reports ARMED"),
    (EmergencyProgress.REFUSED, True, "EMERGENCY STOP REFUSED by the vehicle, but the vehicle reports ARMED"),
    (EmergencyProgress.ACCEPTED, True, "EMERGENCY STOP acknowledged, but the vehicle reports ARMED"),
    (EmergencyProgress.SENT, False, "EMERGENCY STOP sent, waiting for an answer; the vehicle reports dis"),
    (EmergencyProgress.UNANSWERED, False, "EMERGENCY STOP sent, NOT acknowledged; the vehicle reports disarmed"),
    (EmergencyProgress.REFUSED, False, "EMERGENCY STOP REFUSED by the vehicle; the vehicle reports disarmed"),
    (EmergencyProgress.ACCEPTED, False, "EMERGENCY STOP acknowledged, disarmed. Hold t to release it"),
]


@pytest.mark.parametrize(("progress", "armed", "words"), EMERGENCY)
def test_the_emergency_stop_claims_what_the_vehicle_confirmed(
    progress: EmergencyProgress | None, armed: bool, words: str
) -> None:
    state = vehicle(emergency_stop=True, emergency_progress=progress, armed=armed)
    first = active_alerts(DisplayState(snapshot(vehicle=state), STANDARD))[0]
    assert words in first.text
    assert "motors are off" not in first.text
    assert first.level is AlertLevel.DANGER


def test_silence_outranks_the_claims_of_an_emergency_stop() -> None:
    progress = EmergencyProgress.UNANSWERED
    state = vehicle(emergency_stop=True, emergency_progress=progress, alive=False, silence=8.0)
    first, second, *_ = active_alerts(DisplayState(snapshot(vehicle=state), STANDARD))
    assert first.text == "no heartbeat from Rover 1 for 8 s: EMERGENCY STOP NOT acknowledged"
    assert second.text == "EMERGENCY STOP sent, NOT acknowledged, but the vehicle last reported ARMED"


def test_what_needs_a_hand_comes_before_what_is_in_the_way() -> None:
    picture = snapshot(vehicle=vehicle(failsafes=("gcs loss",), refusal="mode denied", limits=tuple(LIMITS)))
    found = active_alerts(DisplayState(picture, STANDARD, GateClosure("no focus")))
    assert [alert.level for alert in found] == sorted((alert.level for alert in found), key=_urgency)


def _urgency(level: AlertLevel) -> int:
    return [AlertLevel.QUESTION, AlertLevel.DANGER, AlertLevel.WARNING].index(level)


NEUTRAL_FIRST = ("neutral first",)


@pytest.mark.parametrize(
    "changes",
    [{"mode": "AUTO"}, {"mode": "HOLD"}, {"in_control": False, "driver": 254}, {"armed": False}],
    ids=["AUTO", "HOLD", "driven by another station", "disarmed"],
)
def test_neutral_first_is_said_only_where_our_keys_drive(changes: dict[str, Any]) -> None:
    def texts(**more: Any) -> list[str]:
        view = vehicle(limits=NEUTRAL_FIRST, **more)
        return [alert.text for alert in active_alerts(DisplayState(snapshot(vehicle=view), STANDARD))]

    assert LIMITS["neutral first"] in texts()
    assert LIMITS["neutral first"] not in texts(**changes)


@pytest.mark.parametrize("closure", [OTHER_SCREEN, TEXT_FIELD])
def test_another_screen_is_no_alert(closure: GateClosure) -> None:
    assert active_alerts(DisplayState(snapshot(), STANDARD, closure=closure)) == []


HINTS: list[tuple[Snapshot, str]] = [
    (waiting(), "no vehicle yet · ? shows the keys, ^q quits"),
    (snapshot(), "hold i to drive · SPACE stops, ! cuts the motors"),
    (snapshot(operator=helm(style="latch")), "press i to drive · SPACE stops, ! cuts the motors"),
    (snapshot(vehicle=vehicle(armed=False)), "disarmed: hold r to arm Rover 1"),
    (snapshot(vehicle=vehicle(armed=False, prearm=True)), "disarmed: hold r to arm Rover 1"),
    (snapshot(vehicle=vehicle(armed=False, prearm=False)), "disarmed: hold r to arm · not ready, pre-arm checks fail"),
    (
        snapshot(vehicle=vehicle(armed=False, prearm=False, prearm_reason="PreArm: Accels inconsistent")),
        "disarmed: hold r to arm · not ready, PreArm: Accels inconsistent",
    ),
    (snapshot(vehicle=vehicle(mode="HOLD")), "HOLD: 1 changes to MANUAL, where the keys drive"),
    (
        snapshot(vehicle=vehicle(mode="AUTO", in_control=False, driver=254)),
        "g asks for control · SPACE stops, ! cuts the motors",
    ),
    (snapshot(vehicle=vehicle(obeys="obeys ground station 250 only")), "SPACE stops, ! cuts the motors"),
    (snapshot(vehicle=vehicle(undriven="keys do not drive it")), "keys do not drive it · ! cuts the motors"),
    (snapshot(vehicle=vehicle(undriven="it flies", may_fall=True)), "it flies · ! asks, then cuts the motors"),
]


@pytest.mark.parametrize(("picture", "words"), HINTS, ids=map(str, range(len(HINTS))))
def test_what_to_do_next(picture: Snapshot, words: str) -> None:
    assert hint(DisplayState(picture, STANDARD)) == words


def test_another_screen_has_a_hint_of_its_own() -> None:
    info = ScreenInfo("log", hint="live")
    assert hint(DisplayState(snapshot(), STANDARD, screen=info)) == "live"


def test_watched_vehicle_is_named_and_one_with_another_link_not() -> None:
    watched = LinkView(name="udpin:127.0.0.1:14550", systems=(1,), watch_only=True)
    other = LinkView(name="serial:/dev/ttyUSB0:57600", systems=(1, 7))

    def texts(*links: LinkView) -> list[str]:
        return [alert.text for alert in active_alerts(DisplayState(snapshot(links=links), STANDARD))]

    assert "Rover 1 is only watched: nothing is sent on udpin:127.0.0.1:14550" in texts(watched)
    assert not [text for text in texts(watched, other) if "watched" in text]


@pytest.mark.parametrize("closure", [OTHER_SCREEN, TEXT_FIELD], ids=["screen", "text"])
def test_a_letter_typed_elsewhere_is_no_alert_on_drive(closure: GateClosure) -> None:
    now = DisplayState(snapshot(operator=helm(ignored=closure.reason)), STANDARD)
    assert not [alert for alert in active_alerts(now) if "key ignored" in alert.text]


def test_without_a_link_no_key_is_offered() -> None:
    picture = snapshot(vehicle=vehicle(alive=False, silence=4.0))
    assert hint(DisplayState(picture, STANDARD)) == "link lost: no key is heard until it is back"
