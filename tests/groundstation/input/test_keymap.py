"""Keys to intents, one read at a time."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from groundstation.actions import ACTIONS
from groundstation.input.keymap import KEYMAPS, KeyEvent, Keymap
from groundstation.intents.driving import DriveKeyDown, DriveKeyUp, EmergencyStop, SetStyle, StepLimits, Stop
from groundstation.intents.union import AnyIntent
from groundstation.intents.vehicle import Disarm, RequestControl, SetMode

STANDARD = Keymap("standard", KEYMAPS["standard"])
TELEOP = Keymap("teleop", KEYMAPS["teleop"])


def read(*keys: str, keymap: Keymap = STANDARD, armed: bool = True, driving: bool = False) -> list[AnyIntent]:
    return keymap.build_intents([KeyEvent(key) for key in keys], armed=armed, driving=driving)


def directions(*keys: str, keymap: Keymap = STANDARD) -> list[tuple[int, int]]:
    pushes = read(*keys, keymap=keymap)
    assert all(isinstance(push, DriveKeyDown) for push in pushes)
    return [(push.throttle, push.steering) for push in pushes if isinstance(push, DriveKeyDown)]


@pytest.mark.parametrize("keymap", [STANDARD, TELEOP], ids=lambda keymap: keymap.name)
def test_the_keys_of_teleop_twist_keyboard(keymap: Keymap) -> None:
    assert directions("u", "i", "o", keymap=keymap) == [(1, -1), (1, 0), (1, 1)]
    assert directions("j", "l", keymap=keymap) == [(0, -1), (0, 1)]
    assert directions("m", "comma", "full_stop", keymap=keymap) == [(-1, 1), (-1, 0), (-1, -1)]
    assert read("k", keymap=keymap) == read("space", keymap=keymap) == [Stop()]


def test_arrows_and_wasd_drive() -> None:
    assert directions("up", "down", "left", "right") == directions("w", "s", "a", "d")
    assert directions("up", "down", "left", "right") == [(1, 0), (-1, 0), (0, -1), (0, 1)]


def test_teleop_speed_keys() -> None:
    assert read("q", "w", "e", keymap=TELEOP) == [StepLimits(0.1, 0.1), StepLimits(0.1, 0.0), StepLimits(0.0, 0.1)]
    assert read("z", "x", "c", keymap=TELEOP) == [StepLimits(-0.1, -0.1), StepLimits(-0.1, 0.0), StepLimits(0.0, -0.1)]


def test_a_push_carries_the_key_and_whether_it_repeats() -> None:
    presses = [KeyEvent("up"), KeyEvent("up", repeat=True), KeyEvent("up", release=True)]
    assert STANDARD.build_intents(presses, armed=True, driving=True) == [
        DriveKeyDown(key="up", throttle=1, steering=0),
        DriveKeyDown(key="up", throttle=1, steering=0, repeat=True),
        DriveKeyUp(key="up"),
    ]


@pytest.mark.parametrize(
    "keys", [("i", "k"), ("k", "i"), ("i", "space", "i", "j"), ("space",), ("i", "i", "k", "u", "w")]
)
def test_a_stop_key_in_a_read_wins(keys: tuple[str, ...]) -> None:
    assert read(*keys) == [Stop()]


def test_emergency_stop_comes_first_and_no_drive_key_is_left() -> None:
    assert read("i", "space", "exclamation_mark", "plus", "j") == [EmergencyStop(), Stop()]
    assert read("f9") == [EmergencyStop(), Stop()]


def test_releases_survive_a_stop_so_that_no_key_stays_down() -> None:
    presses = [KeyEvent("i", release=True), KeyEvent("space")]
    assert STANDARD.build_intents(presses, armed=True, driving=True) == [Stop(), DriveKeyUp(key="i")]


def test_disarming_survives_a_stop() -> None:
    assert read("space", "r", armed=True) == [Stop(), Disarm()]


@pytest.mark.parametrize("key", ["x", "F", "f1", "escape", "enter", "question_mark", "tab", "y", "left_shift", "g"])
def test_any_key_that_drives_nothing_stops_while_driving(key: str) -> None:
    assert read(key, driving=True)[0] == Stop()
    assert not any(isinstance(intent, Stop) for intent in read(key, driving=False))


def test_an_unknown_key_in_the_read_of_a_drive_key_stops() -> None:
    assert read("i", "x") == [Stop()]


def test_a_release_is_no_stop() -> None:
    assert STANDARD.build_intents([KeyEvent("x", release=True)], armed=True, driving=True) == []


def test_speed_keys_neither_stop_nor_drive() -> None:
    assert read("plus", driving=True) == [StepLimits(0.1, 0.1)]
    assert read("right_curly_bracket", driving=True) == [StepLimits(0.0, 0.1)]
    assert read("left_curly_bracket", driving=True) == [StepLimits(0.0, -0.1)]
    assert read("i", "minus") == [DriveKeyDown(key="i", throttle=1, steering=0), StepLimits(-0.1, -0.1)]


def test_arming_is_left_to_a_held_key_and_disarming_is_one_press() -> None:
    assert read("r", armed=False) == []
    assert ACTIONS["vehicle.arm"].confirm
    assert read("r", armed=True) == [Disarm()]
    assert read("t", armed=False) == []


def test_a_held_r_does_not_disarm_again_and_again() -> None:
    assert STANDARD.build_intents([KeyEvent("r", repeat=True)], armed=True, driving=False) == []


def test_vehicle_commands() -> None:
    assert read("1", "2", "g", "ctrl+y") == [SetMode("MANUAL"), SetMode("HOLD"), RequestControl(), SetStyle("next")]


def test_every_binding_names_an_action() -> None:
    for bindings in KEYMAPS.values():
        assert set(bindings.values()) <= set(ACTIONS)


def test_actions_name_themselves() -> None:
    assert all(key == action.id and action.label and action.help for key, action in ACTIONS.items())
    assert STANDARD.get_keys("drive.stop") == ("k", "space", "ctrl+k")
    action = STANDARD.get_action("i")
    assert action is not None
    assert action.id == "drive.forward"
    assert STANDARD.get_action("nonsense") is None


_PRESSES = st.lists(
    st.builds(
        KeyEvent,
        key=st.sampled_from([*KEYMAPS["standard"], "x", "escape", "F3"]),
        repeat=st.booleans(),
        release=st.booleans(),
    ),
    max_size=30,
)


@given(_PRESSES, st.booleans(), st.booleans())
def test_a_read_with_a_stop_in_it_never_drives(presses: list[KeyEvent], armed: bool, driving: bool) -> None:
    intents = STANDARD.build_intents(presses, armed=armed, driving=driving)
    stops = [press for press in presses if press.key in {"k", "space", "f9", "exclamation_mark"} and not press.release]
    assert not stops or Stop() in intents
    if Stop() in intents:
        assert not any(isinstance(intent, (DriveKeyDown, StepLimits)) for intent in intents)
        assert isinstance(intents[0], (Stop, EmergencyStop))


@given(_PRESSES)
def test_no_drive_key_is_lost_in_a_read_without_stops(presses: list[KeyEvent]) -> None:
    drive = [
        press for press in presses if isinstance(getattr(STANDARD.get_action(press.key), "intent", None), DriveKeyDown)
    ]
    intents = STANDARD.build_intents(drive, armed=True, driving=True)
    assert [intent.key for intent in intents if isinstance(intent, (DriveKeyDown, DriveKeyUp))] == [
        press.key for press in drive
    ]


def test_a_key_of_the_speed_may_repeat() -> None:
    keys = STANDARD.get_keys("speed.faster")
    press = KeyEvent(keys[0], repeat=True)
    assert len(STANDARD.build_intents([press], armed=True, driving=False)) == 1


def test_of_two_emergency_stops_one_is_sent() -> None:
    key = STANDARD.get_keys("stop.emergency")[0]
    intents = STANDARD.build_intents([KeyEvent(key), KeyEvent(key)], armed=True, driving=True)
    assert intents == [EmergencyStop(), Stop()]


def test_a_key_map_is_empty_by_default() -> None:
    assert Keymap("mine").get_action("i") is None
