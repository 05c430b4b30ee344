"""The footer."""

from __future__ import annotations

import pytest

from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.ui.widgets.footer import FooterValue, KeyFooter


@pytest.mark.parametrize("width", [80, 100, 140])
@pytest.mark.parametrize("keymap", list(KEYMAPS))
def test_the_footer_always_has_the_stops_and_the_way_out(width: int, keymap: str) -> None:
    line = KeyFooter(FooterValue(Keymap(keymap, KEYMAPS[keymap]))).draw(width, 1)[0].text
    assert len(line) == width
    for words in ("SPACE Stop", "! E-STOP", "? Help", "^q Quit"):
        assert words in line
