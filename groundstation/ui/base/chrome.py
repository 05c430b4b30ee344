"""CHROME: the instruments that every screen has, and InstrumentRow, a row of such a table."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import msgspec

from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.display.hints import hint
from groundstation.ui.widgets.alert import HintLine
from groundstation.ui.widgets.footer import FooterValue, KeyFooter
from groundstation.ui.widgets.instrument import Instrument
from groundstation.ui.widgets.proposal import ProposalBar, ProposalBarValue
from groundstation.ui.widgets.status import StatusBar, StatusBarValue
from groundstation.ui.widgets.tabs import TabBar, TabBarValue

Value = TypeVar("Value")


class InstrumentRow(msgspec.Struct, frozen=True):
    """One instrument of a screen."""

    id: str
    """Id of the widget, for the style sheet of the screen."""
    place: str
    """Where the screen puts it, see DriveScreen.compose; rows of one place stand in the order of the table."""
    build: Callable[..., Instrument[Any]]
    """Called with the first value and `id=`."""
    value: Callable[[DisplayState], Any]
    slow: bool = False
    """Shown at 2 Hz: tables whose figures change all the time."""
    urgent: Callable[[DisplayState], bool] | None = None
    """While it holds, a slow row is shown with each snapshot."""
    layout: str = ""
    """Class of the screen in which it is shown, see ui/drive/layout.py; "": in all."""


def instrument_row(
    id: str,  # noqa: A002
    place: str,
    build: Callable[..., Instrument[Value]],
    value: Callable[[DisplayState], Value],
    *,
    slow: bool = False,
    urgent: Callable[[DisplayState], bool] | None = None,
    layout: str = "",
) -> InstrumentRow:
    """Return a row whose value has the type that its widget shows, which mypy checks here."""
    return InstrumentRow(id, place, build, value, slow, urgent, layout)


STATUS = instrument_row("status", "top", StatusBar, StatusBarValue.from_state)
TABS = instrument_row("tabs", "top", TabBar, TabBarValue.from_state)
HINT = instrument_row("hint", "bottom", HintLine, hint)
FOOTER = instrument_row("footer", "bottom", KeyFooter, FooterValue.from_state)

PROPOSAL_ROWS = 3
"""Of the proposal of an agent, also in the style sheet of ConsoleScreen."""
PROPOSAL = instrument_row("proposal", "bottom", ProposalBar, ProposalBarValue.from_state)

CHROME: tuple[InstrumentRow, ...] = (STATUS, TABS, PROPOSAL, HINT, FOOTER)
"""What every screen but the help has: two lines above its own part, two below, and three while an agent proposes."""
