"""INSTRUMENTS: every instrument of the Drive screen, its place and its value. CHROME: those that all screens have."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import msgspec

from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.display.hints import hint
from groundstation.ui.drive.instruments.heading_tape import HeadingTape, heading_degrees
from groundstation.ui.drive.instruments.health import HealthPanel
from groundstation.ui.drive.instruments.horizon import Horizon, HorizonValue
from groundstation.ui.drive.instruments.key_to_motor import WayPanel, WayValue
from groundstation.ui.drive.instruments.keycaps import Keycaps, KeycapsValue
from groundstation.ui.drive.instruments.links import LinksPanel
from groundstation.ui.drive.instruments.mission import MissionStrip, MissionValue
from groundstation.ui.drive.instruments.speed import SpeedReadout, speed_text
from groundstation.ui.drive.instruments.sticks import StickBars, build_bars
from groundstation.ui.drive.instruments.stops import StopsLine, StopsPanel, StopsValue
from groundstation.ui.drive.instruments.stops_model import is_near
from groundstation.ui.drive.waiting import WaitingPage, WaitingValue
from groundstation.ui.log.panel import LogPanel
from groundstation.ui.widgets.alert import AlertLine, AlertValue, HintLine
from groundstation.ui.widgets.footer import FooterValue, KeyFooter
from groundstation.ui.widgets.instrument import Instrument
from groundstation.ui.widgets.status import StatusBar, StatusBarValue
from groundstation.ui.widgets.tabs import TabBar, TabBarValue

Value = TypeVar("Value")


class InstrumentRow(msgspec.Struct, frozen=True):
    """One instrument of the Drive screen."""

    id: str
    """Id of the widget, for drive.tcss."""
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
    """Class of the screen in which it is shown, see drive_layout.py; "": in all."""


def _row(
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


def _mission(now: DisplayState) -> MissionValue:
    return MissionValue.from_vehicle(now.snapshot.vehicle)


_STATUS = _row("status", "top", StatusBar, StatusBarValue.from_state)
_TABS = _row("tabs", "top", TabBar, TabBarValue.from_state)
_HINT = _row("hint", "bottom", HintLine, hint)
_FOOTER = _row("footer", "bottom", KeyFooter, FooterValue.from_state)

CHROME: tuple[InstrumentRow, ...] = (_STATUS, _TABS, _HINT, _FOOTER)
"""What every screen but the help has: two lines above its own part, two lines below."""

INSTRUMENTS: tuple[InstrumentRow, ...] = (
    _STATUS,
    _TABS,
    _row("waiting", "top", WaitingPage, WaitingValue.from_state),
    _row("mission-line", "left", MissionStrip, _mission, slow=True, layout="-narrow"),
    _row("speed", "motion", SpeedReadout, lambda now: speed_text(now.snapshot.vehicle)),
    _row("horizon", "motion", Horizon, lambda now: HorizonValue.from_vehicle(now.snapshot.vehicle)),
    _row("tape", "heading", HeadingTape, lambda now: heading_degrees(now.snapshot.vehicle)),
    _row("sticks", "drive", StickBars, lambda now: build_bars(now.snapshot)),
    _row("keycaps", "drive", Keycaps, KeycapsValue.from_state),
    _row("way", "readings", WayPanel, lambda now: WayValue.from_snapshot(now.snapshot), slow=True, urgent=is_near,
         layout="-wide"),
    _row("stops", "readings", StopsPanel, StopsValue.from_state, slow=True, urgent=is_near, layout="-wide"),
    _row("health", "readings", HealthPanel, lambda now: now.snapshot.vehicle.health if now.snapshot.vehicle else (),
         slow=True, layout="-wide"),
    _row("links", "readings", LinksPanel, lambda now: now.snapshot.links, slow=True, layout="-tall"),
    _row("mission", "bottom", MissionStrip, _mission, slow=True, layout="-wide"),
    _row("stops-line", "bottom", StopsLine, StopsValue.from_state, slow=True, urgent=is_near, layout="-narrow"),
    _row("log", "bottom", LogPanel, lambda now: now.snapshot.texts),
    _row("alert", "bottom", AlertLine, AlertValue.from_state),
    _HINT,
    _FOOTER,
)  # fmt: skip
