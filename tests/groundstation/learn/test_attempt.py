"""What a pupil did is told from what the rover did: steps go on, wrong deeds get their hint, nothing counts twice."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from msgspec.structs import replace

from groundstation.learn.attempt import Attempt
from groundstation.learn.course import load_course
from groundstation.learn.lesson import Lesson, Step
from groundstation.snapshot import LogLine, OperatorView, ReplayStatus, Snapshot, VehicleView
from groundstation.views.messages import MessageView

NEUTRAL = OperatorView(gate_open=True)
FORWARD = OperatorView(gate_open=True, held=("i",), throttle=0.6)
LEFT = OperatorView(gate_open=True, held=("j",), steering=-0.6)
TICK = 0.2


class Did(NamedTuple):
    """What went on for some time."""

    seconds: float
    operator: OperatorView = NEUTRAL
    changes: Mapping[str, Any] = MappingProxyType({})
    speed: float = 0.0


class Course:
    """A rover that moves as it is told, and an attempt that watches it."""

    def __init__(self, *steps: Step, lesson: Lesson | None = None) -> None:
        self.attempt = Attempt(lesson or Lesson(title="t", text="t", why=("", "", ""), steps=steps))
        who: Any = {"system": 1, "name": "Rover 1", "autopilot": 3, "mode": "MANUAL", "armed": True, "status": 4}
        where: Any = {"alive": True, "silence": 0.0, "position": (0.0, 0.0), "heading": 0.0, "speed": 0.0}
        self.now = Snapshot(vehicle=VehicleView(**who, **where))

    @property
    def vehicle(self) -> VehicleView:
        assert self.now.vehicle is not None
        return self.now.vehicle

    def go(
        self, seconds: float, operator: OperatorView = NEUTRAL, speed: float = 0.0, turn: float = 0.0, **changes: Any
    ) -> None:
        """Let time pass: m/s to the north, rad/s to the right."""
        for _ in range(round(seconds / TICK)):
            position, heading = self.vehicle.position or (0.0, 0.0), self.vehicle.heading or 0.0
            moved = replace(
                self.vehicle,
                position=(position[0] + speed * TICK, position[1]),
                heading=(heading + turn * TICK) % math.tau,
                speed=speed,
                **changes,
            )
            self.now = replace(self.now, uptime=self.now.uptime + TICK, operator=operator, vehicle=moved)
            self.attempt.see(self.now, "drive")


def step(check: str, value: float = 0.0, name: str = "") -> Step:
    return Step(task="t", check=check, value=value, name=name)


def passes(asked: Step) -> Course:
    """Return a course of one step that is seen not to be done by a rover that stands."""
    course = Course(asked)
    course.go(2)
    assert not course.attempt.done
    return course


def test_driving_counts_only_with_the_right_key() -> None:
    course = passes(step("drove_forward", 2))
    course.go(5, speed=1.0)
    course.go(5, LEFT, speed=1.0)
    assert not course.attempt.done
    course.go(3, FORWARD, speed=1.0)
    assert course.attempt.done


def test_a_turn_counts_in_its_direction_also_over_north() -> None:
    course = passes(step("turned_left", 90))
    course.go(2, LEFT, turn=1.0)
    assert not course.attempt.done
    course.go(2, LEFT, turn=-1.0)
    assert course.attempt.done


def test_a_stop_counts_after_motion_and_in_time() -> None:
    course = passes(step("stopped_after_release", 1.0))
    course.go(2, FORWARD, speed=1.0)
    course.go(2, speed=0.5)
    course.go(1)
    assert not course.attempt.done
    course.go(2, FORWARD, speed=1.0)
    course.go(1)
    assert course.attempt.done


def test_a_short_hold_is_told_from_a_long_one() -> None:
    course = passes(step("held_briefly", 2))
    course.go(3, FORWARD)
    course.go(1)
    course.go(1, FORWARD, armed=False)
    course.go(1)
    assert not course.attempt.done
    course.go(1, FORWARD, armed=True)
    course.go(1)
    assert course.attempt.done


def test_a_cut_is_judged_by_where_the_rover_stands() -> None:
    for rolled, done in ((0.0, True), (9.0, False)):
        course = passes(step("stopped_in_cut", 3))
        course.go(2, FORWARD, speed=1.0)
        course.go(2, FORWARD, silence=1.0, speed=1.0)
        lost = (course.vehicle.position or (0.0, 0.0))[0] - 1.8
        course.now = replace(course.now, vehicle=replace(course.vehicle, position=(lost + rolled, 0.0)))
        course.go(1, silence=0.0)
        assert course.attempt.done is done


def test_late_programs_and_texts() -> None:
    course = passes(step("refused_as_late"))
    course.go(1, FORWARD, limits=("stale",))
    assert course.attempt.done
    course = passes(step("moved_without_key", 1))
    course.go(3, FORWARD, speed=1.0, demand=(0.5, 0.0))
    assert not course.attempt.done
    course.go(4, speed=1.0, demand=(0.5, 0.0))
    assert course.attempt.done
    course = passes(step("said", name="mission complete"))
    course.now = replace(
        course.now, texts=(LogLine(time=0, severity=6, label="vehicle", text="Mission complete", number=1),)
    )
    course.go(1)
    assert course.attempt.done


def test_a_replay_counts_where_it_stands_in_the_stop() -> None:
    course = passes(step("paused_at_stop"))
    course.now = replace(course.now, replay=ReplayStatus(file="f", wall=0, position=1, duration=9, playing=True))
    course.go(1, speed=0.4, demand=(0.0, 0.0))
    assert not course.attempt.done
    course.now = replace(course.now, replay=ReplayStatus(file="f", wall=0, position=1, duration=9))
    course.go(1, speed=0.4, demand=(0.6, 0.0))
    assert not course.attempt.done
    course.go(1, speed=0.4, demand=(0.0, 0.0))
    assert course.attempt.done


def test_wrong_deeds_of_the_first_lesson_get_their_hints() -> None:
    course = Course(lesson=load_course()[0].lesson)
    course.go(1, FORWARD, armed=False)
    assert "the rover is disarmed" in course.attempt.hint
    course.go(1, armed=True)
    assert (course.attempt.step, course.attempt.hint) == (1, "")
    course.go(2, LEFT, turn=-1.0)
    assert course.attempt.hint == "That was a turn. Hold `drive.forward`."
    for _ in range(2):
        course.go(3, replace(FORWARD, throttle=-0.6), speed=-0.6)
        assert course.attempt.hint.startswith("That was backward"), "the newest deed, also for the second time"
        course.go(2, LEFT, turn=-1.0)
        assert course.attempt.hint.startswith("That was a turn")
    course.go(9, FORWARD, speed=1.0)
    assert (course.attempt.step, course.attempt.hint) == (2, "")


def test_a_rover_that_holds_again_behind_a_cut_gets_its_hint() -> None:
    """A late HOLD may come behind the MANUAL that the step before has asked for."""
    course = Course()
    course.attempt = Attempt(load_course()[3].lesson, 4)
    course.go(1, FORWARD)
    hints = [course.attempt.hint]
    course.go(1, FORWARD, mode="HOLD")
    hints.append(course.attempt.hint)
    assert hints == ["", "The rover is in mode HOLD now. Press `vehicle.manual`, then hold `drive.forward`."]


def test_wrong_deeds_of_three_more_lessons_get_their_hints() -> None:
    messages, other_rover, parameter = (begin(number, step) for number, step in ((2, 3), (3, 3), (6, 1)))
    messages.attempt.see_view(opened("HEARTBEAT"))
    messages.go(1)
    assert messages.attempt.hint.startswith("That is HEARTBEAT.")
    messages.attempt.see_view(opened("ROVER_OPERATOR_PRESENCE"))
    messages.go(1)
    other_rover.go(3, FORWARD, speed=1.0)
    assert other_rover.attempt.hint.startswith("That was rover 1. Let go")
    other_rover.go(3, FORWARD, speed=1.0, system=2)
    parameter.go(1, FORWARD, armed=False)
    assert "but the rover is disarmed" in parameter.attempt.hint
    parameter.go(3, FORWARD, speed=1.0, armed=True)
    assert [each.attempt.step for each in (messages, other_rover, parameter)] == [3, 3, 1]
    assert [each.attempt.hint for each in (messages, other_rover, parameter)] == ["", "", ""]


WRONG_DEEDS: tuple[tuple[int, int, tuple[Did, ...], str], ...] = (
    (5, 2, (Did(1, FORWARD, {"armed": True}), Did(1)), "Hold `drive.forward` longer"),
    (5, 2, (Did(1, FORWARD, {"armed": False}),), "The rover is disarmed. Hold `vehicle.arm` for 2 s"),
    (5, 2, (Did(21, changes={"mode": "HOLD"}),), "Is the mode HOLD?"),
    (7, 1, (Did(1, FORWARD, {"armed": False}),), "You held a drive key, but the rover is disarmed."),
    (7, 1, (Did(1, changes={"mode": "HOLD"}),), "The rover is in mode HOLD now."),
    (7, 3, (Did(1),), "A rover is armed. Press `app.drive`"),
    (7, 4, (Did(41, changes={"armed": False}),), "Press `/` and `ENTER` again."),
    (8, 1, (Did(31, FORWARD),), "Arrows move the cursor"),
    (8, 3, (Did(41),), "It is not written yet"),
    (8, 5, (Did(1, changes={"armed": False}),), "The rover is disarmed. Press `app.drive`"),
    (9, 2, (Did(61, changes={"armed": False}),), "Does the third terminal say that there is no master?"),
    (9, 3, (Did(1, FORWARD, speed=1.0),), "That was your key. Let go, and let the topic drive."),
    (10, 2, (Did(1, FORWARD, speed=1.0),), "That was your key. Let go, and run the program"),
    (10, 2, (Did(121),), "Is mavhelm installed for that Python?"),
)
"""Lesson and task, what is done in its place, and the beginning of the hint."""


def test_wrong_deeds_of_the_later_lessons_get_their_hints() -> None:
    for number, task, deeds, hint in WRONG_DEEDS:
        course = begin(number, task)
        course.go(0.4, armed=deeds[0].changes.get("armed", True))
        for each in deeds:
            course.go(each.seconds, each.operator, each.speed, **each.changes)
        assert (course.attempt.step, course.attempt.hint.startswith(hint)) == (task - 1, True), (number, task, hint)


RIGHT_DEEDS: tuple[tuple[int, int, tuple[Did, ...]], ...] = (
    (5, 2, (Did(4, FORWARD, {"armed": True, "limits": ("stale",)}),)),
    (7, 1, (Did(3, FORWARD, {"armed": True, "mode": "MANUAL"}, speed=1.0),)),
    (9, 3, (Did(4, NEUTRAL, {"demand": (0.5, 0.0)}, speed=1.0),)),
    (10, 2, (Did(4, NEUTRAL, {"demand": (0.5, 0.0)}, speed=1.0),)),
)


def test_a_task_is_done_behind_a_wrong_deed() -> None:
    for number, task, deeds in RIGHT_DEEDS:
        course = begin(number, task)
        [wrong, *_] = [each for each in WRONG_DEEDS if each[:2] == (number, task)]
        for each in (*wrong[2], Did(2), *deeds):
            course.go(each.seconds, each.operator, each.speed, **each.changes)
        assert (course.attempt.step, course.attempt.hint) == (task, ""), (number, task)


def begin(number: int, task: int) -> Course:
    """Return a lesson of the course at one of its tasks."""
    course = Course()
    course.attempt = Attempt(load_course()[number - 1].lesson, task - 1)
    return course


def opened(name: str) -> MessageView:
    return MessageView(system=1, component=1, sent=False, name=name, id=0, rate=1, count=1, age=0, length=9, fields=())
