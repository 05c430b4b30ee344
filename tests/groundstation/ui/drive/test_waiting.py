"""Page without a vehicle: when it is drawn again."""

from __future__ import annotations

import msgspec

from groundstation.input.keymap import KEYMAPS, Keymap
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.drive.waiting import WaitingValue
from tests.groundstation.ui.examples import waiting

STANDARD = Keymap("standard", KEYMAPS["standard"])


def page(number: int, uptime: float) -> WaitingValue:
    picture = msgspec.structs.replace(waiting(), number=number, uptime=uptime)
    return WaitingValue.from_state(DisplayState(picture, STANDARD))


def test_it_is_the_same_until_its_spinner_turns() -> None:
    assert page(1, 60.0) == page(2, 60.1) == page(3, 60.2) != page(4, 60.3)


def test_what_has_arrived_is_shown_at_once() -> None:
    link = waiting().links[0]
    heard = msgspec.structs.replace(waiting(), links=(msgspec.structs.replace(link, bytes_received=10),))
    before, after = (WaitingValue.from_state(DisplayState(each, STANDARD)) for each in (waiting(), heard))
    assert before != after
