"""TAB_MARKS: marks behind the names of screens in the tab bar, such as a pencil while changes are not sent.

A mark is a function of the display state: of the snapshot, or of what a screen keeps while it is closed (`kept`).
"""

from __future__ import annotations

from collections.abc import Callable

import msgspec

from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.look.colours import BLUE, RED
from groundstation.ui.map.model import MapModel
from groundstation.ui.params.model import ParamModel


class TabMark(msgspec.Struct, frozen=True):
    """A mark behind the name of a screen."""

    text: str
    colour: str
    short: str = ""
    """Where the tab bar is narrow; empty: `text`."""


def _pending_params(now: DisplayState) -> TabMark | None:
    """Return a pencil with the number of parameter changes that are not written."""
    model = now.kept.get(ParamModel)
    pending = len(model.pending) if isinstance(model, ParamModel) else 0
    return TabMark(f"✎{pending}", BLUE, short="✎") if pending else None


def _transfers(now: DisplayState) -> TabMark | None:
    """Return how far the downloads and uploads are."""
    share = now.snapshot.transfers
    return None if share is None else TabMark(f" {100 * share:.0f}%", BLUE)


def _faults(now: DisplayState) -> TabMark | None:
    """Return how many links of the chain from the finger to the wheel stop the operator."""
    count = now.snapshot.faults
    return TabMark(f" {count}✗", RED, short=f"{count}✗") if count else None


def _edited_plans(now: DisplayState) -> TabMark | None:
    """Return a pencil while a plan is not as on the vehicle."""
    model = now.kept.get(MapModel)
    return TabMark("✎", BLUE) if isinstance(model, MapModel) and model.editor.edited else None


TAB_MARKS: dict[str, Callable[[DisplayState], TabMark | None]] = {
    "map": _edited_plans,
    "params": _pending_params,
    "setup": _faults,
    "files": _transfers,
}
"""Id of a row in SCREENS -> its mark, None for no mark."""


def find_marks(now: DisplayState) -> dict[str, TabMark]:
    """Return the marks of a display state, by the id of the screen."""
    found = {screen: mark(now) for screen, mark in TAB_MARKS.items()}
    return {screen: mark for screen, mark in found.items() if mark is not None}
