"""The footer."""

from __future__ import annotations

import msgspec
import pytest

from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.snapshot import Snapshot
from groundstation.snapshot.lease import LeaseView
from groundstation.ui.display.display_state import DisplayState, ScreenInfo, ScreenKey
from groundstation.ui.widgets.footer import FooterValue, KeyFooter
from tests.groundstation.ui.examples import snapshot, vehicle
from tests.groundstation.ui.ptys import STANDARD

STATES = [(False, ""), (True, ""), (False, "16/16"), (True, "16/16")]
"""Armed, and which of several vehicles is selected."""


@pytest.mark.parametrize("width", [80, 100, 140])
@pytest.mark.parametrize("keymap", list(KEYMAPS))
def test_the_footer_always_has_the_stops_and_the_way_out(width: int, keymap: str) -> None:
    for value in (FooterValue(Keymap(keymap, KEYMAPS[keymap]), armed, place) for armed, place in STATES):
        line = KeyFooter(value).draw(width, 1)[0].text
        assert len(line) == width
        for words in ("SPACE Stop", "! E-STOP", "? Help", "^q Quit"):
            assert words in line
        assert ("n Vehicle 16/16" in line) == bool(value.place)


@pytest.mark.parametrize(
    ("systems", "place"), [((), ""), ((1,), ""), ((1, 7), "1/2"), ((0, 1, 7), "2/3"), ((2, 3), "")]
)
def test_the_place_among_several_vehicles(systems: tuple[int, ...], place: str) -> None:
    assert FooterValue.from_state(DisplayState(snapshot(vehicles=systems), STANDARD)).place == place


@pytest.mark.parametrize("keys_mode", ["", "LOITER"])
def test_it_offers_control_only_to_a_screen_without_it(keys_mode: str) -> None:
    def line(shown: Snapshot) -> str:
        value = FooterValue.from_state(DisplayState(shown, STANDARD))
        return KeyFooter(msgspec.structs.replace(value, keys_mode=keys_mode)).draw(200, 1)[0].text

    ours, theirs = snapshot(), snapshot(vehicle=vehicle(in_control=False))
    watched = msgspec.structs.replace(ours, lease=LeaseView(driver="screen on pts/3"))
    assert "G Release control" in line(ours)
    assert "Take control" not in line(ours)
    for shown in (theirs, watched):
        assert "g Take control" in line(shown)
        assert "Release" not in line(shown)


KEYS = (ScreenKey("slash", "Filter", ""), ScreenKey("S", "Save", ""))


@pytest.mark.parametrize(
    ("screen", "words"),
    [
        (ScreenInfo("log", KEYS), "SPACE Stop  ! E-STOP  / Filter  S Save  ESC Drive "),
        (ScreenInfo("log", KEYS, text=True), "^k Stop  ! E-STOP  ENTER Keep  ESC Clear "),
    ],
    ids=["keys", "text"],
)
def test_another_screen_shows_its_stops_and_its_own_keys(screen: ScreenInfo, words: str) -> None:
    line = KeyFooter(FooterValue(STANDARD, screen=screen)).draw(100, 1)[0].text
    assert words in line
    assert "Disarm" not in line
