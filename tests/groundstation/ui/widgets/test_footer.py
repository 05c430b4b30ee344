"""The footer."""

from __future__ import annotations

import pytest

from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.ui.display_state import ScreenInfo, ScreenKey
from groundstation.ui.widgets.footer import FooterValue, KeyFooter
from tests.groundstation.ui.ptys import STANDARD


@pytest.mark.parametrize("width", [80, 100, 140])
@pytest.mark.parametrize("keymap", list(KEYMAPS))
def test_the_footer_always_has_the_stops_and_the_way_out(width: int, keymap: str) -> None:
    line = KeyFooter(FooterValue(Keymap(keymap, KEYMAPS[keymap]))).draw(width, 1)[0].text
    assert len(line) == width
    for words in ("SPACE Stop", "! E-STOP", "? Help", "^q Quit"):
        assert words in line


KEYS = (ScreenKey("slash", "Filter", ""), ScreenKey("S", "Save", ""))


@pytest.mark.parametrize(
    ("screen", "words"),
    [
        (ScreenInfo("log", KEYS), "SPACE Stop  ! E-STOP  / Filter  S Save  ESC Drive "),
        (ScreenInfo("log", KEYS, text=True), "^k Stop  ! E-STOP  ENTER Keep  ESC Clear "),
    ],
    ids=["keys", "text"],
)
def test_another_screen_has_the_stops_that_work_there_and_its_own_keys(screen: ScreenInfo, words: str) -> None:
    line = KeyFooter(FooterValue(STANDARD, screen=screen)).draw(100, 1)[0].text
    assert words in line
    assert "Disarm" not in line
