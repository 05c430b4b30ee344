"""TAB_MARKS: marks behind the names of screens in the tab bar, such as a pencil while changes are not sent.

A mark is a function of the snapshot (TAB_MARKS), or of a model that a screen keeps while it is closed (MarkedModel).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import ClassVar, Protocol, runtime_checkable

import msgspec

from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.look.colours import BLUE, RED


class TabMark(msgspec.Struct, frozen=True):
    """A mark behind the name of a screen."""

    text: str
    colour: str
    short: str = ""
    """Where the tab bar is narrow; empty: `text`."""


@runtime_checkable
class MarkedModel(Protocol):
    """What a screen keeps while it is closed (ScreenContext.keep), with a mark of its own."""

    SCREEN: ClassVar[str]
    """Id of the screen's row in SCREENS."""

    def tab_mark(self) -> TabMark | None:
        """Return the mark, None for no mark."""


def _transfers(now: DisplayState) -> TabMark | None:
    """Return how far the downloads and uploads are."""
    share = now.snapshot.transfers
    return None if share is None else TabMark(f" {100 * share:.0f}%", BLUE)


def _faults(now: DisplayState) -> TabMark | None:
    """Return how many links of the chain from the finger to the wheel stop the operator."""
    count = now.snapshot.faults
    return TabMark(f" {count}✗", RED, short=f"{count}✗") if count else None


TAB_MARKS: dict[str, Callable[[DisplayState], TabMark | None]] = {
    "setup": _faults,
    "files": _transfers,
}
"""Id of a row in SCREENS -> its mark, None for no mark."""


def find_marks(now: DisplayState) -> dict[str, TabMark]:
    """Return the marks of a display state, by the id of the screen."""
    found = {screen: mark(now) for screen, mark in TAB_MARKS.items()}
    found |= {model.SCREEN: model.tab_mark() for model in now.kept.values() if isinstance(model, MarkedModel)}
    return {screen: mark for screen, mark in found.items() if mark is not None}
