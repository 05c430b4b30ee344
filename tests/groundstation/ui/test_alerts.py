"""Which line a driver reads first."""

from __future__ import annotations

import math
from typing import Any

import pytest

from groundstation.input.keymap import ACTIONS
from groundstation.snapshot import LinkView, Snapshot
from groundstation.ui.alerts import LIMITS, Level, Situation, alerts
from groundstation.ui.key_gate import Shut
from tests.groundstation.ui.examples import helm, snapshot, vehicle, waiting
from tests.groundstation.ui.ptys import STANDARD

PROBLEM = LinkView(name="udp", problem="messages arrive with another dialect's checksum: HEARTBEAT")

CASES: list[tuple[Snapshot, dict[str, Any], Level, str]] = [
    (waiting(), {}, Level.HINT, "no vehicle yet"),
    (snapshot(), {}, Level.HINT, "hold i to drive · SPACE stops, ! cuts the motors"),
    (snapshot(vehicle=vehicle(armed=False)), {}, Level.HINT, "disarmed: r, then y, arms Rover 1"),
    (snapshot(vehicle=vehicle(mode="HOLD")), {}, Level.HINT, "HOLD: 1 changes to MANUAL"),
    (snapshot(vehicle=vehicle(limits=("slew", "neutral first"))), {}, Level.WARNING, "neutral first: let go"),
    (snapshot(vehicle=vehicle(limits=("stale",))), {}, Level.WARNING, "stale: the vehicle has no fresh command"),
    (snapshot(vehicle=vehicle(refusal="arm denied: PreArm: battery low")), {}, Level.WARNING, "PreArm: battery low"),
    (snapshot(vehicle=vehicle(failsafes=("gcs loss",))), {}, Level.DANGER, "failsafe: gcs loss"),
    (snapshot(vehicle=vehicle(failsafes=("a",), failsafe_in=3.4)), {}, Level.DANGER, "next step in 3 s"),
    (snapshot(vehicle=vehicle(alive=False, silence=4.0)), {}, Level.DANGER, "no word from Rover 1 for 4 s"),
    (snapshot(vehicle=vehicle(alive=False, silence=math.inf)), {}, Level.DANGER, "for minutes"),
    (snapshot(vehicle=vehicle(emergency_stop=True)), {}, Level.DANGER, "EMERGENCY STOP: the motors are off"),
    (snapshot(vehicle=vehicle(in_control=False, driver=254)), {}, Level.WARNING, "ground station 254 drives: g asks"),
    (snapshot(vehicle=vehicle(in_control=False, driver=None)), {}, Level.WARNING, "you are not in control: g asks"),
    (snapshot(vehicle=vehicle(warnings=("FS_GCS_ENABLE is 0",))), {}, Level.WARNING, "FS_GCS_ENABLE is 0"),
    (snapshot(links=(PROBLEM,)), {}, Level.WARNING, "udp: messages arrive with another"),
    (snapshot(helm=helm(style="latch")), {}, Level.WARNING, "drives on by itself: k or SPACE stops"),
    (snapshot(helm=helm(gate_open=False, gate_reason="the screen was frozen")), {}, Level.WARNING, "was frozen"),
    (snapshot(), {"shut": Shut("the terminal does not answer")}, Level.WARNING, "the terminal does not answer"),
    (snapshot(), {"question": ACTIONS["vehicle.arm"]}, Level.QUESTION, "Arm? y = yes"),
    (snapshot(), {"station_alive": False}, Level.DANGER, "the station process has ended"),
]


@pytest.mark.parametrize(("picture", "more", "level", "words"), CASES, ids=[case[3] for case in CASES])
def test_what_is_said(picture: Snapshot, more: dict[str, Any], level: Level, words: str) -> None:
    first = alerts(Situation(picture, STANDARD, **more))[0]
    assert words in first.text
    assert first.level is level


def test_what_needs_a_hand_comes_before_what_is_in_the_way() -> None:
    picture = snapshot(vehicle=vehicle(failsafes=("gcs loss",), refusal="mode denied", limits=tuple(LIMITS)))
    found = alerts(Situation(picture, STANDARD, Shut("no focus")))
    assert [alert.level for alert in found] == sorted((alert.level for alert in found), key=_urgency)


def _urgency(level: Level) -> int:
    return [Level.QUESTION, Level.DANGER, Level.WARNING, Level.HINT].index(level)
