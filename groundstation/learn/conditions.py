"""CONDITIONS: what a lesson may check, by name. Each is a question to what was seen, never a click."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import msgspec

from groundstation.learn.deeds import STANDING, Deeds
from groundstation.learn.lesson import Checked
from groundstation.snapshot import VehicleView
from groundstation.snapshot.lease import NO_SCREEN

FEW = 3
"""Parameters that a filter leaves when it was used well."""


class LessonCheck(msgspec.Struct, frozen=True):
    """One row."""

    help: str
    """When it is true, for the table of docs/teach.md; N is the value."""
    holds: Callable[[Deeds, Checked], bool]
    unit: str = ""
    """Of the value; "" where it takes none."""
    named: str = ""
    """What the name is: "screen", "message", "parameter" or "text"; "" where it takes none."""


def _vehicle(test: Callable[[VehicleView], bool]) -> Callable[[Deeds, Checked], bool]:
    return lambda deeds, asked: deeds.now.vehicle is not None and test(deeds.now.vehicle)


def _at_least(measured: Callable[[Deeds], float]) -> Callable[[Deeds, Checked], bool]:
    return lambda deeds, asked: measured(deeds) >= asked.value


def _at_most(measured: Callable[[Deeds], float | None]) -> Callable[[Deeds, Checked], bool]:
    """Return a check that is not true before anything was measured."""

    def holds(deeds: Deeds, asked: Checked) -> bool:
        value = measured(deeds)
        return value is not None and value <= asked.value

    return holds


def _said(deeds: Deeds, asked: Checked) -> bool:
    return any(asked.name.casefold() in text.casefold() for text in deeds.texts)


def _in_mode(deeds: Deeds, asked: Checked) -> bool:
    return deeds.now.vehicle is not None and deeds.now.vehicle.mode == asked.name


def _found_param(deeds: Deeds, asked: Checked) -> bool:
    return asked.name in deeds.found_params and len(deeds.found_params) <= FEW


def _drove_system(deeds: Deeds, asked: Checked) -> bool:
    return deeds.driven.get(int(asked.value), 0.0) >= 1.0


def _changed(deeds: Deeds, asked: Checked) -> bool:
    value, changed = deeds.params.get(asked.name, (0.0, False))
    return changed and value >= asked.value


CONDITIONS: Mapping[str, LessonCheck] = {
    "armed": LessonCheck("the rover is armed", _vehicle(lambda vehicle: vehicle.armed)),
    "disarmed": LessonCheck("the rover is disarmed", _vehicle(lambda vehicle: not vehicle.armed)),
    "drove_forward": LessonCheck("N m forward with a key", _at_least(lambda deeds: deeds.forward), "m"),
    "drove_backward": LessonCheck("N m back with a key", _at_least(lambda deeds: deeds.backward), "m"),
    "turned_left": LessonCheck("N degrees to the left", _at_least(lambda deeds: deeds.left), "degrees"),
    "turned_right": LessonCheck("N degrees to the right", _at_least(lambda deeds: deeds.right), "degrees"),
    "stopped_after_release": LessonCheck(
        "stood at most N s after the key was let go", _at_most(lambda deeds: deeds.stop_time), "s"
    ),
    "reached_speed": LessonCheck("N m/s or faster with a key", _at_least(lambda deeds: deeds.top_speed), "m/s"),
    "lost_while_driving": LessonCheck(
        "nothing was heard for N s while a key was held", _at_least(lambda deeds: deeds.silence), "s"
    ),
    "stopped_in_cut": LessonCheck(
        "stood at most N m behind where the link was lost", _at_most(lambda deeds: deeds.cut_stop), "m"
    ),
    "refused_as_late": LessonCheck("the rover refused demands as too old", lambda deeds, asked: deeds.late >= 2),
    "heard_vehicles": LessonCheck("N vehicles are heard", _at_least(lambda deeds: len(deeds.now.vehicles)), "vehicles"),
    "drove_system": LessonCheck("the rover with id N was driven by 1 m", _drove_system, "id"),
    "drove_itself": LessonCheck("N m in an autonomous mode", _at_least(lambda deeds: deeds.itself), "m"),
    "moved_without_key": LessonCheck("N m by the demand of a program", _at_least(lambda deeds: deeds.without_key), "m"),
    "turned_without_key": LessonCheck(
        "N degrees by the demand of a program", _at_least(lambda deeds: deeds.turned_without_key), "degrees"
    ),
    "on_screen": LessonCheck("this screen is shown", lambda deeds, asked: deeds.screen == asked.name, named="screen"),
    "opened_message": LessonCheck(
        "the fields of this message were shown", lambda deeds, asked: asked.name in deeds.messages, named="message"
    ),
    "found_param": LessonCheck(
        "the list of parameters shows this one, and few others", _found_param, named="parameter"
    ),
    "changed_param": LessonCheck(
        "this parameter is not at its default, and at least N", _changed, "as the parameter", "parameter"
    ),
    "said": LessonCheck("the log has a new line with this text", _said, named="text"),
    "has_plan": LessonCheck(
        "the rover has a mission",
        _vehicle(lambda vehicle: vehicle.mission is not None and bool(vehicle.mission.places)),
    ),
    "in_mode": LessonCheck("the rover is in this mode", _in_mode, named="text"),
    "recorded": LessonCheck("the recording is N s long", _at_least(lambda deeds: deeds.recorded), "s"),
    "replays": LessonCheck("a log is shown", lambda deeds, asked: deeds.now.replay is not None),
    "paused_at_stop": LessonCheck(
        "a replay stands where the rover still rolls, and nothing is demanded of it any more",
        lambda deeds, asked: deeds.paused_at_stop,
    ),
    "gave_up_keys": LessonCheck(
        "no screen has the keys, so that a program may drive",
        lambda deeds, asked: deeds.now.lease.driver == NO_SCREEN,
    ),
    "emergency_stop": LessonCheck("the emergency stop holds", _vehicle(lambda vehicle: vehicle.emergency_stop)),
    "key_while_disarmed": LessonCheck(
        "a drive key was held while the rover was disarmed", lambda deeds, asked: deeds.held_disarmed
    ),
    "held_briefly": LessonCheck(
        "a drive key was let go within N s, armed", _at_most(lambda deeds: deeds.shortest_hold), "s"
    ),
    "stands": LessonCheck("the rover stands", _vehicle(lambda vehicle: abs(vehicle.speed or 0.0) < STANDING)),
    "waited": LessonCheck("N s went by", _at_least(lambda deeds: deeds.waited), "s"),
}
"""Name -> row; docs/teach.md has the same table."""


def is_done(deeds: Deeds, asked: Checked) -> bool:
    """Return whether a condition is true of what was seen."""
    return CONDITIONS[asked.check].holds(deeds, asked)
