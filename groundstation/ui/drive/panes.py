"""PANES: what a driver can have beside the instruments of the Drive screen. A new pane is a row here.

Panes take no keys; one key shows the next pane, two keys zoom. What a pane needs beside the snapshot it requests, and
only while it is shown.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, TypeVar

import msgspec

from groundstation.snapshot import LogLine
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.drive.camera_feed import CameraFeed, CameraValue
from groundstation.ui.drive.instruments.camera import CameraPicture
from groundstation.ui.drive.instruments.horizon import Horizon, HorizonValue
from groundstation.ui.drive.instruments.links import LinksPanel
from groundstation.ui.drive.instruments.rates import RatesPanel
from groundstation.ui.drive.instruments.track import TrackMap, TrackValue
from groundstation.ui.log.panel import LogPanel
from groundstation.ui.look.colours import AMBER, GREEN
from groundstation.ui.map.draw.plan_map import PlanMap
from groundstation.ui.map.draw.plan_map_value import PlanMapValue
from groundstation.ui.map.pane import build_pane
from groundstation.ui.map.plan.copies import PlanCopies
from groundstation.ui.widgets.chart import SPAN, Chart, ChartValue, Series
from groundstation.ui.widgets.instrument import Instrument, finite_or_none
from groundstation.views.base import View, ViewRequest
from groundstation.views.camera import CameraRequest
from groundstation.views.drive import SpeedRequest, SpeedView, TrackRequest, TrackView
from groundstation.views.messages import MessagesPage, MessagesRequest

Value = TypeVar("Value")
ViewType = TypeVar("ViewType", bound=View)

FAST, SLOW = 0.2, 0.5
"""s between two updates of a pane: each changes many of its lines, which is expensive over SSH."""

ROWS = 60
"""Rows of messages that are requested: as many as the largest terminal shows."""


class PaneInput(msgspec.Struct, frozen=True):
    """What a pane draws from."""

    now: DisplayState
    views: Mapping[type[View], View] = msgspec.field(default_factory=dict)
    """The newest view of each kind."""
    zoom: int = 0
    plans: PlanCopies | None = None
    """Plans of the vehicle, for a pane that wants them."""
    camera: CameraFeed | None = None
    """Its camera, for the pane that shows it."""

    def view(self, kind: type[ViewType]) -> ViewType | None:
        """Return the newest view of a kind."""
        found = self.views.get(kind)
        return found if isinstance(found, kind) else None


class Pane(msgspec.Struct, frozen=True):
    """One pane."""

    id: str
    """Its title, too."""
    build: Callable[..., Instrument[Any]]
    """Called with the first value and `id=`."""
    value: Callable[[PaneInput], Any]
    requests: tuple[ViewRequest, ...] = ()
    period: float = SLOW
    """s between updates."""
    zooms: tuple[int, int] = (0, 0)
    """Least and largest zoom; 0 is the usual one."""
    wants_plans: bool = False
    """It draws PaneInput.plans, whose views are requested while it is shown."""


def _pane(
    id: str,  # noqa: A002
    build: Callable[..., Instrument[Value]],
    value: Callable[[PaneInput], Value],
    *requests: ViewRequest,
    period: float = SLOW,
    zooms: tuple[int, int] = (0, 0),
    wants_plans: bool = False,
) -> Pane:
    """Return a row whose value has the type that its widget shows, which mypy checks here."""
    return Pane(id, build, value, requests, period, zooms, wants_plans)


def _track(given: PaneInput) -> TrackValue:
    vehicle, track = given.now.snapshot.vehicle, given.view(TrackView)
    points = track.points if track is not None and vehicle is not None and track.system == vehicle.system else ()
    return TrackValue.from_vehicle(vehicle, points, ascii=given.now.ascii, zoom=given.zoom)


def _map(given: PaneInput) -> PlanMapValue:
    vehicle = given.now.snapshot.vehicle
    if given.plans is None or vehicle is None:
        return PlanMapValue("no vehicle yet")
    return build_pane(given.plans, vehicle, ascii=given.now.ascii)


def speed_samples(given: PaneInput) -> ChartValue:
    """Return the speed and the demanded speed; each zoom step halves the time that is shown."""
    speeds, vehicle = given.view(SpeedView), given.now.snapshot.vehicle
    if speeds is None or vehicle is None or speeds.system != vehicle.system:
        return ChartValue()
    samples = tuple((at, (speed, demanded)) for at, speed, demanded in speeds.points)
    return ChartValue(samples, SPAN * 0.5**given.zoom)


def camera_value(given: PaneInput) -> CameraValue:
    """Return the picture of the camera, and its age."""
    vehicle = given.now.snapshot.vehicle
    age = None if vehicle is None else finite_or_none(vehicle.command_age)
    return CameraValue() if given.camera is None else given.camera.value(ascii=given.now.ascii, command_age=age)


def _log(given: PaneInput) -> tuple[LogLine, ...]:
    return given.now.snapshot.texts


SPEED_CHART = partial(
    Chart, title="speed", unit="m/s", series=(Series("", GREEN), Series("asked", AMBER, dotted=True)), step=0.5
)

PANES: tuple[Pane, ...] = (
    _pane("track", TrackMap, _track, TrackRequest(), period=FAST, zooms=(-3, 5)),
    _pane("map", PlanMap, _map, wants_plans=True),
    _pane("charts", SPEED_CHART, speed_samples, SpeedRequest(), zooms=(0, 3)),
    _pane("messages", RatesPanel, lambda given: given.view(MessagesPage), MessagesRequest(count=ROWS)),
    _pane("log", LogPanel, _log),
    _pane("links", LinksPanel, lambda given: given.now.snapshot.links),
    _pane("horizon", Horizon, lambda given: HorizonValue.from_vehicle(given.now.snapshot.vehicle), period=FAST),
    _pane("camera", CameraPicture, camera_value, CameraRequest(), period=FAST),
)
"""In the order in which the key shows them; the first one is shown at the start."""

CAMERA = next(index for index, pane in enumerate(PANES) if pane.id == "camera")
SECOND = next(index for index, pane in enumerate(PANES) if pane.id == "messages")
"""The second pane at the start, in terminals that have room for two: the speed chart is there anyway."""
