"""Scripts of keys: errors with file and line, and what keys do at each moment."""

from __future__ import annotations

import pytest

from dialects.axes import Axes
from groundstation.formats.errors import FileFormatError
from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.input.sticks import Sticks
from groundstation.intents.base import Intent
from groundstation.intents.driving import EmergencyStop
from groundstation.intents.vehicle import Disarm, SetMode
from groundstation.verbs.control.key_script import KeyScript
from groundstation.verbs.control.key_script_file import parse_script

STANDARD = Keymap("standard", KEYMAPS["standard"])


def play(text: str, *moments: float, keymap: Keymap = STANDARD) -> tuple[list[Axes], list[Intent]]:
    """Return the axes at each moment, and all that is requested of the vehicle, which is armed."""
    script = KeyScript(parse_script(text, "run.keys", keymap), keymap, Sticks(limit=0.5))
    script.begin(100.0)
    axes: list[Axes] = []
    requested: list[Intent] = []
    for moment in moments:
        while (intents := script.play(True, 100.0 + moment)) is not None:
            requested += intents
        axes.append(script.axes(100.0 + moment))
    return axes, requested


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("", "run.keys: no line such as '0.5 press i'"),
        ("0.5 press", "run.keys:1: '0.5 press' is not TIME press|release KEY"),
        ("# begin\n\n0.5 push i", "run.keys:3: '0.5 push i' is not TIME"),
        ("nan press i", "run.keys:1: 'nan' is not a time"),
        ("-1 press i", "run.keys:1: '-1' is not a time"),
        ("1 press i\n0.5 release i", "run.keys:2: 0.5 s is before 1 s of line 1"),
        ("1 press i\n2 press i", "run.keys:2: i is held since line 1"),
        ("1 press i\n2 release i\n3 release i", "run.keys:3: i is not held"),
        ("1 press y", "run.keys:1: the key map standard has no key 'y'"),
        ("1 press t", "run.keys:1: 't' is 'Clear e-stop', which a script cannot do"),
        ("1 press f2", "run.keys:1: 'f2' is 'Map', which a script cannot do"),
        ("1 press hello", "run.keys:1: unknown key 'hello'"),
        ("1 press i\n10.5 release i", "run.keys:2: i is held for more than 9 s"),
    ],
)
def test_an_error_names_file_and_line(text: str, error: str) -> None:
    with pytest.raises(FileFormatError) as raised:
        parse_script(text, "run.keys", STANDARD)
    assert str(raised.value).startswith(error)


def test_keys_drive_while_they_are_held() -> None:
    text = "0.5 press i  # forward\n1 press l\n1.5 release l\n2 release i\n"
    axes, requested = play(text, 0.4, 0.5, 1.2, 1.6, 2.0)
    assert axes == [Axes(), Axes(0.5, 0.0), Axes(0.5, 0.5), Axes(0.5, 0.0), Axes()]
    assert requested == []


def test_every_other_key_stops_and_drive_key_is_pressed_again() -> None:
    axes, requested = play("0 press i\n1 press 2\n2 press up\n3 press space\n", 0.5, 1.5, 2.5, 3.5)
    assert [each.throttle for each in axes] == [0.5, 0.0, 0.5, 0.0]
    assert requested == [SetMode(mode="HOLD")]


def test_keys_that_request_something_of_the_vehicle() -> None:
    _, requested = play("0 press r\n1 press !\n2 press 1", 5.0)
    assert requested == [Disarm(), EmergencyStop(), SetMode(mode="MANUAL")]


def test_keys_mean_what_the_key_map_says() -> None:
    teleop = Keymap("teleop", KEYMAPS["teleop"])
    axes, _ = play("0 press q\n0.1 press i\n", 0.2, keymap=teleop)
    assert axes == [Axes(0.6, 0.0)]  # q is faster there
    with pytest.raises(FileFormatError, match="the key map teleop has no key 'd'"):
        parse_script("0 press d", "run.keys", teleop)
