"""Findings D6, D7 and D12: what a stranger provokes neither hides nor delays the texts that matter."""

from __future__ import annotations

import sys
from collections.abc import Callable
from types import FrameType
from typing import Any

import pytest

from dialects import messages as m
from dialects.enums import Command, Result
from dialects.modes import Mode
from link.core import Peer
from link.services.param.values import REAL32
from tests.vehicle.bench import AHEAD, CYCLE, DRIVER, NEUTRAL, OTHER, Bench, logged
from vehicle.safety.states import SafetyState

STRANGER = 66
SAFE, RELEASE = 0, 1
SWITCH = Command.DO_SET_SAFETY_SWITCH_STATE


class FloodedBench(Bench):
    """A bench with a stranger that sets unknown parameters, two in each cycle: 100 a second."""

    flooding = False
    unknown = 0

    def _tick(self) -> None:
        for _ in range(2 if self.flooding else 0):
            self.unknown += 1
            self.say(m.ParamSet(1, 1, b"X%d" % self.unknown, 1.0, REAL32), STRANGER)
        super()._tick()


def texts_to(bench: Bench, peer: Peer) -> list[str]:
    """Return the texts that reached one ground station, chunks joined."""
    texts: list[str] = []
    for message, only in zip(bench.sent, bench.peers, strict=True):
        if isinstance(message, m.StatusText) and only in (None, peer):
            if message.chunk_seq:
                texts[-1] += m.decode_text(message)
            else:
                texts.append(m.decode_text(message))
    return texts


def test_a_stranger_at_100_a_second_hides_no_safety_text() -> None:
    bench = FloodedBench()
    assert bench.command(Command.COMPONENT_ARM_DISARM, 1) is Result.ACCEPTED
    bench.wait(0.2, NEUTRAL)
    bench.flooding = True
    bench.wait(10.0, AHEAD)
    assert bench.turning
    bench.wait(4.0)  # silence: a failsafe and HOLD
    assert bench.mode is Mode.HOLD
    bench.wait(4.0, NEUTRAL)
    bench.set_mode(Mode.MANUAL)
    bench.wait(4.0, NEUTRAL)
    bench.set_mode(Mode.HOLD)
    bench.wait(1.0, NEUTRAL)
    assert bench.command(SWITCH, SAFE) is Result.ACCEPTED
    assert bench.rover.state is SafetyState.ESTOP
    bench.wait(1.0, NEUTRAL)
    assert bench.command(SWITCH, RELEASE) is Result.ACCEPTED
    bench.wait(1.0, NEUTRAL)
    assert bench.command(Command.COMPONENT_ARM_DISARM, 1) is Result.ACCEPTED
    bench.wait(1.0, NEUTRAL)
    assert bench.command(Command.COMPONENT_ARM_DISARM, 0) is Result.ACCEPTED
    bench.wait(1.0, NEUTRAL)
    assert bench.unknown > 2500
    reached = texts_to(bench, bench.station)
    for part in (
        "GCS 255 is in control",
        "Armed by GCS 255, mode MANUAL",
        "Failsafe: manual control lost: ",
        "Failsafe cleared: manual control lost",
        "Mode MANUAL",
        "Mode HOLD",
        "EMERGENCY STOP by GCS 255",
        "Emergency stop released, disarmed",
        "Armed by GCS 255, mode HOLD",
        "Disarmed: by GCS 255",
    ):
        assert any(part in text for text in reached), part
        assert logged(bench, part), part
    assert any("HOLD" in text for text in reached if text.startswith("Failsafe: manual"))


def test_a_refusal_goes_to_its_asker_only_and_within_its_budget() -> None:
    bench = FloodedBench()
    assert bench.arm() is Result.ACCEPTED
    bench.flooding = True
    bench.wait(20.0, NEUTRAL)
    refusals = [text for text in texts_to(bench, Peer(0, f"gcs {STRANGER}")) if "you are not in control" in text]
    assert 12 <= len(refusals) <= 12 + 2 * 21
    assert not any("you are not in control" in text for text in texts_to(bench, bench.station))
    assert sum("you are not in control" in text for text in bench.logged) <= 30 + 21


def test_the_refusals_of_one_asker_leave_the_budget_of_another() -> None:
    bench = FloodedBench()
    assert bench.arm() is Result.ACCEPTED
    bench.flooding = True
    bench.wait(20.0, NEUTRAL)
    assert bench.command(Command.COMPONENT_ARM_DISARM, 1, system=OTHER) is Result.FAILED
    bench.wait(CYCLE)
    assert "PreArm: armed already by GCS 255" in texts_to(bench, Peer(0, f"gcs {OTHER}"))
    assert "PreArm: armed already by GCS 255" not in texts_to(bench, bench.station)


def test_nothing_is_sent_to_an_asker_without_heartbeat() -> None:
    bench = Bench()
    bench.command(Command.COMPONENT_ARM_DISARM, 1, system=STRANGER, introduced=False)
    bench.wait(1.0)
    assert bench.texts == []
    assert logged(bench, "GCS 66: COMPONENT_ARM_DISARM refused: no HEARTBEAT received")


def test_arm_disarm_arm_are_three_texts() -> None:
    bench = Bench()
    for wanted in (1, 0, 1, 0):
        assert bench.command(Command.COMPONENT_ARM_DISARM, wanted) is Result.ACCEPTED
        bench.wait(0.3)
    for texts in (texts_to(bench, bench.station), bench.logged):
        events = [text for text in texts if text.startswith(("Armed", "Disarmed"))]
        assert events == ["Armed by GCS 255, mode MANUAL", "Disarmed: by GCS 255"] * 2


def operations(action: Callable[[], None]) -> int:
    """Count the bytecode instructions that an action executes."""
    count = 0

    def trace(frame: FrameType, event: str, argument: Any) -> Any:
        nonlocal count
        frame.f_trace_opcodes = True
        count += event == "opcode"
        return trace

    before = sys.gettrace()
    sys.settrace(trace)
    try:
        action()
    finally:
        sys.settrace(before)
    return count


@pytest.mark.parametrize("system", [DRIVER, STRANGER])
def test_a_refusal_costs_the_same_after_10_and_after_3000(system: int) -> None:
    bench = Bench()
    assert bench.arm() is Result.ACCEPTED

    def cost(number: int) -> int:
        return operations(lambda: bench.say(m.ParamSet(1, 1, b"X%04d" % number, 1.0, REAL32), system))

    for number in range(100):
        bench.say(m.ParamSet(1, 1, b"X%04d" % number, 1.0, REAL32), system)
    early = min(cost(number) for number in range(100, 110))
    for number in range(110, 3000):
        bench.say(m.ParamSet(1, 1, b"X%04d" % number, 1.0, REAL32), system)
    late = min(cost(number) for number in range(3000, 3010))
    assert late <= early * 1.1
