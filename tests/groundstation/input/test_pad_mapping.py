"""The mapping of the gamepad: what the config file may say, and the buttons as keys."""

from __future__ import annotations

from typing import Any

import pytest

from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.input.pad_mapping import (
    DEFAULT_BUTTONS,
    PadMapping,
    add_buttons,
    build_mapping,
    find_pad_conflict,
    find_pad_problems,
)


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("deadman", "r1", "is none of a, b, x"),
        ("throttle", "leftx", "is none of lefty, righty, triggers"),
        ("steering", 3, "is none of leftx"),
        ("expo", 2, "is not a number from 0 to 1"),
        ("dead_zone", "big", "is not a number from 0 to 0.5"),
        ("start", "vehicle.armed", "unknown action 'vehicle.armed'; did you mean vehicle.arm"),
        ("a", ["drive.stop"], "is not the id of an action"),
        ("dpup", "drive.forward", "drives, which only the sticks do while the dead-man button is held"),
        ("deadmen", "a", "unknown entry; did you mean deadman"),
    ],
)
def test_each_mistake_is_one_line(name: str, value: Any, words: str) -> None:
    [line] = find_pad_problems(name, value)
    assert words in line
    assert "\n" not in line


def test_the_dead_man_button_can_do_nothing_else() -> None:
    assert find_pad_conflict({"deadman": "start", "start": "vehicle.arm"}) is not None
    assert find_pad_conflict({"rightshoulder": "vehicle.arm"}) is not None
    assert find_pad_conflict({"deadman": "start", "start": ""}) is None
    assert "start" not in build_mapping({"deadman": "start"}).buttons, "its usual action gives way"


def test_entries_replace_the_usual_ones() -> None:
    mapping = build_mapping({"throttle": "triggers", "expo": 0, "y": "", "a": "drive.stop"})
    assert (mapping.throttle, mapping.steering, mapping.expo) == ("triggers", PadMapping().steering, 0.0)
    expected = {name: action for name, action in DEFAULT_BUTTONS.items() if name != "y"}
    assert mapping.buttons == {**expected, "a": "drive.stop"}


def test_buttons_are_further_keys_of_their_actions() -> None:
    keymap = add_buttons(Keymap("standard", KEYMAPS["standard"]), PadMapping())
    assert keymap.get_keys("vehicle.arm") == ("r", "pad_start")
    assert [list(find_pad_problems(name, action)) for name, action in DEFAULT_BUTTONS.items()] == [[]] * len(
        DEFAULT_BUTTONS
    )


def test_each_dead_man_button_has_a_name() -> None:
    assert (PadMapping().deadman_name, PadMapping(deadman="leftstick").deadman_name) == ("RB", "L3")


def test_a_button_may_do_nothing() -> None:
    assert list(find_pad_problems("y", "")) == []


def test_a_dead_man_button_of_another_type_is_no_conflict() -> None:
    assert find_pad_conflict({"deadman": ["a"]}) is None
    assert len(list(find_pad_problems("deadman", ["a"]))) == 1


@pytest.mark.parametrize(("name", "largest"), [("dead_zone", 0.5), ("expo", 1.0)])
def test_shares_have_their_range(name: str, largest: float) -> None:
    for value in (0.0, largest):
        assert list(find_pad_problems(name, value)) == []
    for value in (-0.01, largest + 0.01):
        assert len(list(find_pad_problems(name, value))) == 1


def test_the_usual_mapping_in_numbers() -> None:
    mapping = PadMapping()
    assert (mapping.dead_zone, mapping.expo) == (0.12, 0.3)
