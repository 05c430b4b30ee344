"""Drive screen: the instruments and a pane. Keys that drive, stop or command take another way, see key_gate.py."""

from __future__ import annotations

from collections.abc import Callable

from msgspec.structs import replace
from textual import events
from textual.app import ComposeResult
from textual.containers import Horizontal, Vertical
from textual.css.scalar import Scalar
from textual.widgets import Static

from groundstation.intents.driving import DriveByPicture
from groundstation.intents.session import StartSimulator
from groundstation.snapshot import Snapshot, VehicleView
from groundstation.ui.base.chrome import InstrumentRow
from groundstation.ui.base.screen import ConsoleScreen, ScreenContext
from groundstation.ui.display.alerts import active_alerts
from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.drive.camera_feed import CameraFeed, CameraValue
from groundstation.ui.drive.instrument_table import INSTRUMENTS
from groundstation.ui.drive.instruments.camera import CameraPicture
from groundstation.ui.drive.instruments.links import LinksPanel, vehicle_links
from groundstation.ui.drive.instruments.stops import StopsPanel
from groundstation.ui.drive.instruments.strip import DrivingStrip, StripValue
from groundstation.ui.drive.layout import (
    CLASSES,
    CONSOLE_SIZE,
    LOW_CONSOLE_SIZE,
    MIN_STRIP_SIZE,
    Size,
    is_smaller,
    layout_classes,
)
from groundstation.ui.drive.pane import CLOSER, WIDER, PaneFrame
from groundstation.ui.drive.panes import CAMERA, SECOND, SPEED_CHART, PaneInput, camera_value, speed_samples
from groundstation.ui.drive.picture_drawing import PictureDrawing
from groundstation.ui.map.plan.copies import PlanCopies
from groundstation.ui.terminal.key_parser import KeyRepeat
from groundstation.ui.widgets.chart import ChartValue
from groundstation.views.base import View, ViewRequest
from groundstation.views.camera import CameraRequest, CameraView
from groundstation.views.drive import SpeedRequest, SpeedView

BORDERS = 2
"""Rows of the border of a panel."""
MOST_LINKS = 6
"""Lines of the panel of the links: three links. The pane of the links and the Links screen show all."""

BESIDE_PICTURE = ("motion", "heading", "drive", "readings")
"""Places that the full picture hides, with all that is in them."""

SLOW = 0.5
"""s between updates of slow rows. Each update changes all their lines, which is expensive over SSH."""


class DriveScreen(ConsoleScreen):
    """The instruments of one display state."""

    CSS_PATH = "screen.tcss"
    ROWS = INSTRUMENTS

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._slow_at = -SLOW
        self._too_small_text = ""
        self._strip = DrivingStrip(StripValue.from_state(self._state), id="strip")
        self._plans = PlanCopies()
        self._camera = CameraFeed(self._show_picture, context.pictures)
        self._drawing = PictureDrawing(self, self._camera, self._picture_value)
        self._pane_before: int | None = None
        """The pane that the full picture replaces; None while it is not shown."""
        self._panes = (
            PaneFrame(0, self._state, self._plans, self._camera, id="pane"),
            PaneFrame(SECOND, self._state, self._plans, self._camera, id="pane2"),
        )
        self._chart = SPEED_CHART(ChartValue(), id="speeds")
        self._views: dict[type[View], View] = {}
        self._reported = False
        """The station was told that the driver drives by the picture."""
        # Before the first style update, which would have to be made again.
        self.add_class(*(name for name, applies in _conditions(self._state).items() if applies), update=False)

    @property
    def snapshot(self) -> Snapshot:
        """What is shown."""
        return self._state.snapshot

    def compose(self) -> ComposeResult:
        """Lay out the places of INSTRUMENTS; drive.tcss sets their sizes."""
        self._choose_layout()  # before there are widgets, which need no second style then
        with Vertical(id="console"):
            yield from self.build_place("top")
            with Horizontal(id="body"):
                with Vertical(id="left"):
                    yield self._panes[0]
                    yield from self.build_place("left")
                yield self._panes[1]
                with Vertical(id="instruments"):
                    with Horizontal(id="motion") as motion:
                        motion.border_title = "motion"
                        yield from self.build_place("motion")
                    yield from self.build_place("heading")
                    with Vertical(id="drive") as drive:
                        drive.border_title = "drive"
                        yield from self.build_place("drive")
                    yield self._chart
                with Vertical(id="readings"):
                    yield from self.build_place("readings")
            yield from self.build_place("bottom")
        yield self._strip
        yield Static(id="too-small", markup=False)
        yield from self.build_pane()

    def on_resize(self, event: events.Resize) -> None:
        """Show what fits: a layout of the console, the driving strip, or the size that is needed."""
        self._choose_layout()
        self._show_small()

    def on_screen_resume(self, event: events.ScreenResume) -> None:
        """Show what has changed while another screen was on top."""
        if self.is_mounted:
            self.show_state(self._state)

    def _choose_layout(self) -> None:
        """Set the classes of a size: at once, because each update matches all style rules with all widgets."""
        size = self.room
        chosen = layout_classes(size)
        too_small = is_smaller(size, MIN_STRIP_SIZE)
        small = {"-too-small": too_small, "-strip": is_smaller(size, self._console_size) and not too_small}
        small["-low"] = not small["-strip"] and is_smaller(size, CONSOLE_SIZE)
        self.update_classes({name: name in chosen for name in CLASSES} | small)

    @property
    def too_small(self) -> bool:
        """Not even the driving strip fits."""
        return is_smaller(self.room, MIN_STRIP_SIZE)

    @property
    def _small(self) -> bool:
        return is_smaller(self.room, self._console_size)

    @property
    def _console_size(self) -> Size:
        """The least size of the console: above the pane of a lesson it does without some rows."""
        return CONSOLE_SIZE if self.context.lesson is None else LOW_CONSOLE_SIZE

    def _show_small(self) -> None:
        if self.too_small:
            self._show_too_small()
        elif self._small:
            self._strip.show(StripValue.from_state(self._state))

    def _show_too_small(self) -> None:
        width, height = self.room
        text = (
            f"This terminal has {width} x {height} characters.\n"
            f"Driving needs {MIN_STRIP_SIZE[0]} x {MIN_STRIP_SIZE[1]}.\n\n"
            f"{format_arming(self.snapshot.vehicle)}\n\n"
            "Keys neither drive nor arm now;\nstop, disarm and emergency stop work."
        )
        if text != self._too_small_text:
            self._too_small_text = text
            self.query_one("#too-small", Static).update(text)

    def show_body(self, now: DisplayState) -> None:
        """Show what depends on the size, the vehicle and the alerts."""
        self._show_small()
        self.update_classes(_conditions(now))

    # ---- panes ----

    @property
    def actions(self) -> dict[str, Callable[[], None]]:
        """Id of an action -> what it does."""
        return {
            "view.pane": self._show_next_pane,
            "view.picture": self._switch_picture,
            "view.closer": lambda: self._panes[0].zoom(CLOSER),
            "view.wider": lambda: self._panes[0].zoom(WIDER),
        }

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the views of what is shown."""
        if self._small or self.snapshot.vehicle is None:
            return ()
        wanted = [self._with_port(request) for pane in self._shown_panes for request in pane.requests]
        chart = [SpeedRequest()] if self.has_class("-chart") and self._pane_before is None else []
        return tuple(dict.fromkeys([*wanted, *chart]))

    def _with_port(self, request: ViewRequest) -> ViewRequest:
        return self._camera.request if isinstance(request, CameraRequest) else request

    def show_view(self, view: View) -> None:
        """Show what the station sent for a pane or the chart."""
        self._plans.show_view(view)
        first = type(view) not in self._views
        self._views[type(view)] = view
        if isinstance(view, CameraView):
            self._follow_camera()  # in a replay that stands still no other state comes
        if isinstance(view, SpeedView):
            self._chart.show(speed_samples(PaneInput(self._state, self._views)))
        if first:  # else it waits for the next update of the pane
            for pane in self._shown_panes:
                pane.show_view(self._views)

    @property
    def _shown_panes(self) -> tuple[PaneFrame, ...]:
        both = self.has_class("-large") and self._pane_before is None
        return self._panes if both else self._panes[:1]

    def _switch_picture(self) -> None:
        """Drive by the picture of the camera, or by eye again."""
        pane = self._panes[0]
        if self._pane_before is None:
            self._pane_before = pane.index
            pane.turn_to(CAMERA)
        else:
            pane.turn_to(self._pane_before)
            self._pane_before = None
            for row in INSTRUMENTS:
                if row.place in BESIDE_PICTURE:
                    self.show_row(row)
        self.update_classes({"-picture": self._pane_before is not None})
        self._report_picture()
        self._show_panes()

    def _report_picture(self) -> None:
        """Tell the station what the driver sees: it decides whether keys drive."""
        drives = self._pane_before is not None
        if drives or self._reported:
            self._reported = drives
            self.context.send(DriveByPicture(drives, self._camera.taken_at))

    def _picture_value(self) -> CameraValue:
        return camera_value(self._panes[0].given)

    @property
    def _pictures(self) -> list[CameraPicture]:
        return [] if self._small else [each for pane in self._shown_panes if (each := pane.camera) is not None]

    def _show_picture(self) -> None:
        """Show a new picture."""
        if not self._drawing.waits and self._drawing.show(self._pictures) and self._pane_before is not None:
            self._report_picture()

    def _follow_camera(self) -> None:
        """Let the decoder run while a pane shows the camera."""
        shown = self._pictures
        view, vehicle = self._views.get(CameraView), self.snapshot.vehicle
        known = isinstance(view, CameraView) and vehicle is not None and view.system == vehicle.system
        self._drawing.follow(view if known else None, shown)  # type: ignore[arg-type]

    def leave(self) -> None:
        """End the decoder: another screen is on top."""
        self._drawing.stop()

    def _show_next_pane(self) -> None:
        if self._pane_before is not None:
            self._switch_picture()
            return
        for pane in self._panes:
            pane.turn_on()
        self._show_panes()

    def _show_panes(self) -> None:
        for pane in self._shown_panes:
            pane.show(self._state, self._views)
        self._panes[0].set_hint(self._state.key("view.pane"))
        self._drawing.draw_pixels(self._pictures)

    # ---- instruments ----

    def show_rows(self) -> None:
        """Show the state in the instruments of this layout, in slow ones less often."""
        due = self._is_slow_due(self.snapshot)
        for row in INSTRUMENTS:
            shown = not row.layout or self.has_class(row.layout)
            if shown and (due or not row.slow or (row.urgent is not None and row.urgent(self._state))):
                self.show_row(row)
        if due:
            self._fit_panels()
        if self.snapshot.vehicle is not None and not self._small:
            self._show_panes()
        self._follow_camera()
        if self._pane_before is not None:
            self._report_picture()

    def show_row(self, row: InstrumentRow) -> None:
        """Show the state in an instrument, unless the full picture hides it."""
        if self._pane_before is None or row.place not in BESIDE_PICTURE:
            super().show_row(row)

    def _fit_panels(self) -> None:
        """Give the panel of the stop bounds no more rows than it has lines, and that of the links two for each."""
        links = self._built["links"]
        height = Scalar.from_number(min(MOST_LINKS, links.wanted if isinstance(links, LinksPanel) else 0) + BORDERS)
        if links.styles.height != height:
            links.styles.height = height
        panel = self._built["stops"]
        most = Scalar.from_number((panel.wanted if isinstance(panel, StopsPanel) else 0) + BORDERS)
        if panel.styles.max_height != most:
            panel.styles.max_height = most

    def _is_slow_due(self, snapshot: Snapshot) -> bool:
        if snapshot.vehicle is None or 0 <= snapshot.uptime - self._slow_at < SLOW:
            return False
        self._slow_at = snapshot.uptime
        return True

    def light_keycaps(self, pressed: frozenset[str]) -> None:
        """Light the caps of keys that are down, without waiting for the next display state."""
        self._state = replace(self._state, pressed=pressed)
        for row in INSTRUMENTS:
            if row.id == "keycaps":
                self.show_row(row)

    def perform_key(self, event: events.Key) -> bool:
        """Handle actions of the app; keys that drive, stop or command were sent by the input thread."""
        if isinstance(event, KeyRepeat):
            return False
        action = self.context.keymap.get_action(event.key)
        if action is not None and action.intent is None:
            self.context.perform(action)
            return True
        if action is None and event.key == "enter" and self.snapshot.vehicle is None:
            self.context.send(StartSimulator())
            return True
        return False


def _conditions(now: DisplayState) -> dict[str, bool]:
    """Return the style classes that depend on the state, and whether they apply."""
    vehicle = now.snapshot.vehicle
    no_legs = vehicle is None or vehicle.mission is None or not vehicle.mission.legs
    return {
        "-waiting": vehicle is None,
        "-no-legs": no_legs,
        "-links": len(vehicle_links(now.snapshot.links)) > 1,
        "-flight": vehicle is not None and vehicle.flies,
        "-alert": bool(active_alerts(now)),
    }


def format_arming(vehicle: VehicleView | None) -> str:
    """Return what a driver must know in any case: name, mode, armed or not, emergency stop, silence."""
    if vehicle is None:
        return "no vehicle yet"
    parts = [vehicle.name, vehicle.mode, "ARMED" if vehicle.armed else "DISARMED"]
    if vehicle.emergency_stop:
        parts.append("EMERGENCY STOP")
    if not vehicle.alive:
        parts.append("no heartbeat")
    return " · ".join(parts)
