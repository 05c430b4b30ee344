"""INSTRUMENTS: every instrument of the Drive screen, its place and its value. CHROME: those that all screens have."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

from groundstation.snapshot import VehicleView
from groundstation.ui.alerts import hint
from groundstation.ui.colours import BLUE, GREEN
from groundstation.ui.display_state import DisplayState
from groundstation.ui.widgets.alert import AlertLine, AlertValue, HintLine
from groundstation.ui.widgets.chart import Chart, Samples, Series
from groundstation.ui.widgets.footer import FooterValue, KeyFooter
from groundstation.ui.widgets.heading_tape import HeadingTape, heading_degrees
from groundstation.ui.widgets.horizon import Horizon, HorizonValue
from groundstation.ui.widgets.instrument import Instrument
from groundstation.ui.widgets.keycaps import Keycaps, KeycapsValue
from groundstation.ui.widgets.links import LinksPanel
from groundstation.ui.widgets.log import LogPanel
from groundstation.ui.widgets.rates import RatesPanel
from groundstation.ui.widgets.speed import SpeedReadout, speed_text
from groundstation.ui.widgets.status import StatusBar, StatusBarValue
from groundstation.ui.widgets.sticks import StickBars, build_bars
from groundstation.ui.widgets.tabs import TabBar, TabBarValue
from groundstation.ui.widgets.track import TrackMap, TrackValue
from groundstation.ui.widgets.waiting import WaitingPage, WaitingValue

Value = TypeVar("Value")


@dataclass(frozen=True, slots=True)
class InstrumentRow:
    """One instrument of the Drive screen."""

    id: str
    """Id of the widget, for drive.tcss."""
    place: str
    """Where the screen puts it, see DriveScreen.compose; rows of one place stand in the order of the table."""
    build: Callable[..., Instrument[Any]]
    """Called with the first value and `id=`."""
    value: Callable[[DisplayState], Any]
    slow: bool = False
    """Shown only in the wide layout, at 2 Hz: charts and tables, which change all their lines each time."""


def _row(
    id: str,  # noqa: A002
    place: str,
    build: Callable[..., Instrument[Value]],
    value: Callable[[DisplayState], Value],
    *,
    slow: bool = False,
) -> InstrumentRow:
    """Return a row whose value has the type that its widget shows, which mypy checks here."""
    return InstrumentRow(id, place, build, value, slow)


def _samples(now: DisplayState, field: Callable[[VehicleView], float | None]) -> Samples:
    vehicle = now.snapshot.vehicle
    return () if vehicle is None else ((now.snapshot.uptime, (field(vehicle),)),)


_SPEED_CHART = partial(Chart, title="speed", unit="m/s", series=(Series("", GREEN),), step=0.5)
_BATTERY_CHART = partial(Chart, title="battery", unit="V", series=(Series("", BLUE),), step=0.5)

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
    _row("track", "left", TrackMap, lambda now: TrackValue.from_vehicle(now.snapshot.vehicle, ascii=now.ascii)),
    _row("speed", "motion", SpeedReadout, lambda now: speed_text(now.snapshot.vehicle)),
    _row("horizon", "motion", Horizon, lambda now: HorizonValue.from_vehicle(now.snapshot.vehicle)),
    _row("tape", "heading", HeadingTape, lambda now: heading_degrees(now.snapshot.vehicle)),
    _row("sticks", "drive", StickBars, lambda now: build_bars(now.snapshot)),
    _row("keycaps", "drive", Keycaps, KeycapsValue.from_state),
    _row("speeds", "charts", _SPEED_CHART, lambda now: _samples(now, lambda vehicle: vehicle.speed), slow=True),
    _row("battery", "charts", _BATTERY_CHART, lambda now: _samples(now, lambda vehicle: vehicle.battery_voltage),
         slow=True),
    _row("rates", "traffic", RatesPanel, lambda now: now.snapshot.messages, slow=True),
    _row("links", "traffic", LinksPanel, lambda now: now.snapshot.links, slow=True),
    _row("log", "bottom", LogPanel, lambda now: now.snapshot.texts),
    _row("alert", "bottom", AlertLine, AlertValue.from_state),
    _HINT,
    _FOOTER,
)  # fmt: skip
