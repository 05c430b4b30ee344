"""The messages panel."""

from __future__ import annotations

from groundstation.ui.drive.instruments.rates import RatesPanel
from tests.groundstation.ui.examples import MESSAGE_ROWS, MESSAGES_PAGE
from tests.groundstation.ui.frames import texts


def test_a_table_that_is_too_long_says_so() -> None:
    lines = texts(RatesPanel(MESSAGES_PAGE).draw(40, 6))
    assert lines[-1] == f"and {len(MESSAGE_ROWS) - 4} more"
    assert lines[1].startswith("Rover 1")
    assert len(RatesPanel(MESSAGES_PAGE).draw(40, 30)) == len(MESSAGE_ROWS) + 1
    assert texts(RatesPanel(None).draw(40, 6)) == [" nothing yet"]
