"""CONDITIONS: what a lesson may check, by name. Each is a question to what was seen, never a click."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import msgspec

from groundstation.learn.deeds import STANDING, Deeds
from groundstation.learn.lesson import Checked
from groundstation.snapshot import VehicleView

FEW = 3
"""Parameters that a filter leaves when it was used well."""


class Condition(msgspec.Struct, frozen=True):
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


def _said(deeds: Deeds, asked: Checked) -> bool:
    return any(asked.name.casefold() in text.casefold() for text in deeds.texts)


def _drove_system(deeds: Deeds, asked: Checked) -> bool:
    return deeds.driven.get(int(asked.value), 0.0) >= 1.0


def _changed(deeds: Deeds, asked: Checked) -> bool:
    value, changed = deeds.params.get(asked.name, (0.0, False))
    return changed and value >= asked.value


CONDITIONS: Mapping[str, Condition] = {
    "armed": Condition("the rover is armed", _vehicle(lambda vehicle: vehicle.armed)),
    "disarmed": Condition("the rover is disarmed", _vehicle(lambda vehicle: not vehicle.armed)),
    "drove_forward": Condition("N m forward with a key", lambda deeds, asked: deeds.forward >= asked.value, "m"),
    "drove_backward": Condition("N m back with a key", lambda deeds, asked: deeds.backward >= asked.value, "m"),
    "turned_left": Condition("N degrees to the left", lambda deeds, asked: deeds.left >= asked.value, "degrees"),
    "turned_right": Condition(
        "N degrees to the right", lambda deeds, asked: deeds.right >= asked.value, "degrees"
    ),
    "stopped_after_release": Condition(
        "stood at most N s after the key was let go",
        lambda deeds, asked: deeds.stop_time is not None and deeds.stop_time <= asked.value,
        "s",
    ),
    "reached_speed": Condition(
        "N m/s or faster with a key", lambda deeds, asked: deeds.top_speed >= asked.value, "m/s"
    ),
    "lost_while_driving": Condition(
        "nothing was heard for N s while a key was held", lambda deeds, asked: deeds.silence >= asked.value, "s"
    ),
    "stopped_in_cut": Condition(
        "stood at most N m behind where the link was lost",
        lambda deeds, asked: deeds.cut_stop is not None and deeds.cut_stop <= asked.value,
        "m",
    ),
    "refused_as_late": Condition("the rover refused demands as too old", lambda deeds, asked: deeds.late >= 2),
    "heard_vehicles": Condition(
        "N vehicles are heard", lambda deeds, asked: len(deeds.now.vehicles) >= asked.value, "vehicles"
    ),
    "drove_system": Condition("the rover with id N was driven by 1 m", _drove_system, "id"),
    "drove_itself": Condition(
        "N m in an autonomous mode", lambda deeds, asked: deeds.itself >= asked.value, "m"
    ),
    "moved_without_key": Condition(
        "N m by the demand of a program", lambda deeds, asked: deeds.without_key >= asked.value, "m"
    ),
    "turned_without_key": Condition(
        "N degrees by the demand of a program",
        lambda deeds, asked: deeds.turned_without_key >= asked.value,
        "degrees",
    ),
    "on_screen": Condition("this screen is shown", lambda deeds, asked: deeds.screen == asked.name, named="screen"),
    "opened_message": Condition(
        "the fields of this message were shown", lambda deeds, asked: asked.name in deeds.messages, named="message"
    ),
    "found_param": Condition(
        "the list of parameters shows this one, and few others",
        lambda deeds, asked: asked.name in deeds.found_params and len(deeds.found_params) <= FEW,
        named="parameter",
    ),
    "changed_param": Condition(
        "this parameter is not at its default, and at least N", _changed, "as the parameter", "parameter"
    ),
    "said": Condition("the log has a new line with this text", _said, named="text"),
    "has_plan": Condition(
        "the rover has a mission",
        _vehicle(lambda vehicle: vehicle.mission is not None and bool(vehicle.mission.places)),
    ),
    "in_mode": Condition(
        "the rover is in this mode",
        lambda deeds, asked: deeds.now.vehicle is not None and deeds.now.vehicle.mode == asked.name,
        named="text",
    ),
    "recorded": Condition(
        "the recording is N s long", lambda deeds, asked: deeds.recorded >= asked.value, "s"
    ),
    "replays": Condition("a log is shown", lambda deeds, asked: deeds.now.replay is not None),
    "paused_at_stop": Condition(
        "a replay stands where the rover still rolls, and nothing is demanded of it any more",
        lambda deeds, asked: deeds.paused_at_stop,
    ),
    "emergency_stop": Condition("the emergency stop holds", _vehicle(lambda vehicle: vehicle.emergency_stop)),
    "key_while_disarmed": Condition(
        "a drive key was held while the rover was disarmed", lambda deeds, asked: deeds.held_disarmed
    ),
    "stands": Condition("the rover stands", _vehicle(lambda vehicle: abs(vehicle.speed or 0.0) < STANDING)),
    "waited": Condition("N s went by", lambda deeds, asked: deeds.waited >= asked.value, "s"),
}  # fmt: skip
"""Name -> row; docs/teach.md has the same table."""


def is_done(deeds: Deeds, asked: Checked) -> bool:
    """Return whether a condition is true of what was seen."""
    return CONDITIONS[asked.check].holds(deeds, asked)
