"""INSTRUMENTS: every instrument of the Drive screen, its place and its value."""

from __future__ import annotations

from groundstation.ui.base.chrome import FOOTER, HINT, STATUS, TABS, InstrumentRow, instrument_row
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.drive.instruments.heading_tape import HeadingTape, heading_degrees
from groundstation.ui.drive.instruments.health import HealthPanel
from groundstation.ui.drive.instruments.horizon import Horizon, HorizonValue
from groundstation.ui.drive.instruments.key_to_motor import WayPanel, WayValue
from groundstation.ui.drive.instruments.keycaps import Keycaps, KeycapsValue
from groundstation.ui.drive.instruments.links import LinksPanel
from groundstation.ui.drive.instruments.mission import MissionStrip, MissionValue
from groundstation.ui.drive.instruments.speed import Readout, SpeedReadout
from groundstation.ui.drive.instruments.sticks import StickBars, build_bars
from groundstation.ui.drive.instruments.stops import StopsLine, StopsPanel, StopsValue
from groundstation.ui.drive.instruments.stops_model import is_near
from groundstation.ui.drive.waiting import WaitingPage, WaitingValue
from groundstation.ui.log.panel import LogPanel
from groundstation.ui.widgets.alert import AlertLine, AlertValue
from groundstation.ui.widgets.proposal import ProposalLines


def _mission(now: DisplayState) -> MissionValue:
    return MissionValue.from_vehicle(now.snapshot.vehicle)


INSTRUMENTS: tuple[InstrumentRow, ...] = (
    STATUS,
    TABS,
    instrument_row("waiting", "top", WaitingPage, WaitingValue.from_state),
    instrument_row("mission-line", "left", MissionStrip, _mission, slow=True, layout="-narrow"),
    instrument_row("speed", "motion", SpeedReadout, lambda now: Readout.from_vehicle(now.snapshot.vehicle)),
    instrument_row("horizon", "motion", Horizon, lambda now: HorizonValue.from_vehicle(now.snapshot.vehicle)),
    instrument_row("tape", "heading", HeadingTape, lambda now: heading_degrees(now.snapshot.vehicle)),
    instrument_row("sticks", "drive", StickBars, lambda now: build_bars(now.snapshot)),
    instrument_row("keycaps", "drive", Keycaps, KeycapsValue.from_state),
    instrument_row("way", "readings", WayPanel, lambda now: WayValue.from_snapshot(now.snapshot), slow=True,
                   urgent=is_near, layout="-wide"),
    instrument_row("stops", "readings", StopsPanel, StopsValue.from_state, slow=True, urgent=is_near, layout="-wide"),
    instrument_row("health", "readings", HealthPanel,
                   lambda now: now.snapshot.vehicle.health if now.snapshot.vehicle else (), slow=True, layout="-wide"),
    instrument_row("links", "readings", LinksPanel, lambda now: now.snapshot.links, slow=True, layout="-chart"),
    instrument_row("mission", "bottom", MissionStrip, _mission, slow=True, layout="-wide"),
    instrument_row("stops-line", "bottom", StopsLine, StopsValue.from_state, slow=True, urgent=is_near,
                   layout="-narrow"),
    instrument_row("log", "bottom", LogPanel, lambda now: now.snapshot.texts),
    instrument_row("proposal", "bottom", ProposalLines, lambda now: now.snapshot.proposal),
    instrument_row("alert", "bottom", AlertLine, AlertValue.from_state),
    HINT,
    FOOTER,
)  # fmt: skip
