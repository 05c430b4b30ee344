"""Links screen: all vehicles, all links, and who is in control; chooses the vehicle that the keys drive."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence

from textual import events
from textual.containers import Horizontal
from textual.widget import Widget

from groundstation.actions import ACTIONS
from groundstation.intents.links import CloseLink
from groundstation.intents.vehicle import SelectVehicle
from groundstation.ui.base.list_keys import rows_to_move
from groundstation.ui.base.panels import PanelHeights, share_rows
from groundstation.ui.base.screen import LIST_ARROWS, ConsoleScreen, ScreenContext
from groundstation.ui.display.alerts import handover_text
from groundstation.ui.display.display_state import DisplayState, ScreenInfo, ScreenKey
from groundstation.ui.display.wrap import plain
from groundstation.ui.keys.keynames import format_key
from groundstation.ui.links.control_panel import ControlPanel, ControlPanelValue
from groundstation.ui.links.link_table import LinkTable, LinkTableValue
from groundstation.ui.links.vehicle_table import VehicleTable, VehicleTableValue
from groundstation.ui.links.where import build_where
from groundstation.ui.map.draw.plan_map import PlanMap
from groundstation.ui.map.draw.plan_map_value import PlanMapValue
from groundstation.ui.messages.byte_counts import MessageBytes
from groundstation.ui.terminal.key_parser import KeyRepeat
from groundstation.views.base import View, ViewRequest
from groundstation.views.links import (
    ControlRequest,
    ControlView,
    LinksRequest,
    LinksView,
    VehicleRow,
    VehiclesRequest,
    VehiclesView,
)
from groundstation.views.messages import MessagesPage, MessagesRequest

WIDE, TALL = 120, 36
"""Columns from which there is a panel beside the vehicles and the control, and rows from which it gets its own."""

BYTES_ROWS = 9
"""Messages that are listed by their bytes."""
BYTES_SOURCES = 60
"""Rows that are requested for it: the same message of several vehicles is one line."""

CHROME_ROWS = 4
"""Status line, tabs, hint and footer."""

TYPING_TIME = 1.0
"""s within which a further digit belongs to the same system id."""

LINKS_PANEL = 1
"""Number of the panel of the links."""

PAGE = 6
"""Rows of a page: its keys move by one less."""

COMMANDS = ("vehicle.next", "vehicle.control", "vehicle.release", "vehicle.give", "vehicle.keep")
"""Actions of the Drive screen whose keys work here too. None of them drives, and each is neutral first."""


class LinksScreen(ConsoleScreen):
    """Three panels; TAB chooses the one that has the arrows and the room."""

    CSS_PATH = "screen.tcss"
    KEYS = (
        ScreenKey(
            "enter", "Choose", "Choose the vehicle under the cursor; the one before gets neutral first", commands=True
        ),
        ScreenKey("tab", "Panel", "Next panel: vehicles, links, control"),
        ScreenKey("a", "Add", "Open a link: goes to the Connect screen"),
        ScreenKey("x", "Close", "Close the link under the cursor, after a question", commands=True),
    )

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._vehicles = VehicleTable(VehicleTableValue(), id="vehicle-table")
        self._links = LinkTable(LinkTableValue(), id="link-table")
        self._control = ControlPanel(ControlPanelValue(), id="control-panel")
        self._where = PlanMap(PlanMapValue(), id="where")
        self._bytes = MessageBytes(None, id="message-bytes")
        self._panels: tuple[Widget, ...] = (self._vehicles, self._links, self._control)
        self._places: tuple[Widget, ...] = (
            Horizontal(self._vehicles, self._where),
            self._links,
            Horizontal(self._control, self._bytes),
        )
        """Rows of the screen: a panel, with what is beside it where there is room."""
        self._chosen = 0
        self._cursor: int | None = None
        """System id under the cursor; None: it follows the selected vehicle."""
        self._typed, self._typed_at = "", 0.0
        self._link: int | None = None
        """Index of the link under the cursor."""

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the panels below each other, and beside two of them what a wide terminal has room for."""
        titles = ("vehicles", "links", "who is in control", "where", "bytes by message")
        for panel, title in zip((*self._panels, self._where, self._bytes), titles, strict=True):
            self.build_panel(panel, title)
        return self._places

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the requests for the views of the panels that are shown."""
        wide = (MessagesRequest(order="bytes", count=BYTES_SOURCES),) if self.room.width >= WIDE else ()
        return VehiclesRequest(), LinksRequest(), ControlRequest(), *wide

    def show_view(self, view: View) -> None:
        """Keep a view for its panel."""
        match view:
            case VehiclesView():
                self._show_vehicles(view)
            case LinksView():
                self._show_links(view)
                self._links.border_subtitle = plain(describe_links(view))
            case ControlView():
                keys = (self._state.key("vehicle.control"), self._state.key("vehicle.release"))
                self._control.show(ControlPanelValue(view, *keys, self._control.value.top))
            case MessagesPage() if view.order == "bytes":
                self._bytes.show(view)
                self._bytes.border_subtitle = plain(f"{view.bytes / 1000:.1f} kB/s")
        self._lay_out()

    def show_body(self, now: DisplayState) -> None:
        """Show which vehicle is selected; the rest comes with the views."""
        self._show_vehicles(self._vehicles.value.view)

    def on_resize(self, event: events.Resize) -> None:
        """Share the rows of the new size."""
        self._lay_out()

    def describe(self) -> ScreenInfo:
        """Return the keys of this screen with those of COMMANDS, as the key map has them."""
        info = super().describe()
        keys = [(self.context.keymap.get_keys(each), ACTIONS[each]) for each in COMMANDS[:3]]
        extra = [ScreenKey(names[0], action.label, action.help, commands=True) for names, action in keys if names]
        return ScreenInfo(info.id, (*info.keys, *extra), info.hint, info.text)

    @property
    def advice(self) -> str:
        """Return what ENTER would do, or how to move; first of all a request that waits for an answer."""
        if asks := handover_text(self._state):
            return asks
        chosen, under = self._selected_name(), self._vehicles.value.under_cursor
        drive = format_key(next(iter(self.context.keymap.get_keys("app.drive")), "escape"))
        if self._chosen:
            close = "x closes the link, a adds one · " if self._chosen == LINKS_PANEL else ""
            return f"↑ ↓ scrolls · {close}TAB goes on to the next panel · ESC goes back to Drive"
        if under is not None and under.system != self._vehicles.value.selected:
            return f"ENTER chooses {under.name}; {chosen or 'the one before'} gets neutral first"
        if len(self._rows) > 1:
            return f"↑ ↓ or a system id moves, ENTER chooses · {drive} drives {chosen}"
        return self.HINT

    # ---- keys ----

    def choose_panel_of(self, widget: Widget) -> tuple[str, str] | None:
        """Give the arrows to the panel of a widget."""
        if widget not in self._panels:
            return None
        self._chosen = self._panels.index(widget)
        self._show_links(self._links.value.view)
        self._lay_out()
        return LIST_ARROWS

    def perform_key(self, event: events.Key) -> bool:
        """Handle the keys of this screen."""
        action = self.context.keymap.get_action(event.key)
        repeated = isinstance(event, KeyRepeat)
        if rows := rows_to_move(event.key, PAGE, letters=False):
            self._step(rows)
        elif event.key.isdecimal():
            self._type(event.key)
        elif event.key == "enter" and not repeated:
            self._choose()
        elif event.key == "tab" and not repeated:
            self._chosen = (self._chosen + 1) % len(self._panels)
            self._show_links(self._links.value.view)
        elif event.key in ("a", "x") and not repeated:
            self._add() if event.key == "a" else self._close()
        elif action is not None and action.id in COMMANDS and action.intent is not None and not repeated:
            self._cursor = None if action.id == "vehicle.next" else self._cursor
            self.context.send(action.intent)
        else:
            return False
        self._lay_out()
        return True

    @property
    def marked_text(self) -> str:
        """The name and system id of the vehicle under the cursor, or the endpoint of the link."""
        if self._chosen == LINKS_PANEL:
            view = self._links.value.view
            return next((each.name for each in view.rows if each.index == self._link), "") if view else ""
        under = self._vehicles.value.under_cursor
        return f"{under.name}, system id {under.system}" if under is not None and not self._chosen else ""

    def _step(self, rows: int) -> None:
        if self._chosen:
            self._scroll(rows)
            return
        systems = [each.system for each in self._rows]
        if systems:
            at = systems.index(self._vehicles.value.cursor) if self._vehicles.value.cursor in systems else 0
            self._cursor = systems[max(0, min(len(systems) - 1, at + rows))]

    def _scroll(self, rows: int) -> None:
        """Scroll the links or the lines about control, as far as there is something to see."""
        if self._chosen == LINKS_PANEL:
            self._move_link(rows)
            return
        value = self._control.value
        top = max(0, min(self._control.wanted - self._control.size.height, value.top + rows))
        self._control.show(ControlPanelValue(value.view, value.request_key, value.release_key, top))

    def _move_link(self, rows: int) -> None:
        """Move the cursor in the links."""
        view = self._links.value.view
        indexes = [link.index for link in view.rows] if view else []
        if indexes:
            at = indexes.index(self._link) if self._link in indexes else 0
            self._link = indexes[max(0, min(len(indexes) - 1, at + rows))]
            self._show_links(view)

    def _add(self) -> None:
        self.context.perform(ACTIONS["app.connect"])

    def _close(self) -> None:
        view = self._links.value.view
        link = next((each for each in view.rows if each.index == self._links.value.cursor), None) if view else None
        if link is None:
            self.say("TAB to the links first, then x closes the one under the cursor")
            return
        neutral = "; what is driven over it gets neutral first" if link.frames_in else ""
        self.ask(f"close {link.name}{neutral}", lambda: self.context.send(CloseLink(link=link.index)))

    def _type(self, digit: str) -> None:
        """Move to the vehicle whose system id is typed."""
        now = time.monotonic()
        self._typed = self._typed + digit if now - self._typed_at <= TYPING_TIME else digit
        self._typed_at = now
        if any(str(each.system) == self._typed for each in self._rows):
            self._cursor = int(self._typed)

    def _choose(self) -> None:
        under = self._vehicles.value.under_cursor
        if under is not None and not self._chosen and under.system != self._vehicles.value.selected:
            self.context.send(SelectVehicle(system=under.system))

    # ---- drawing ----

    @property
    def _rows(self) -> Sequence[VehicleRow]:
        view = self._vehicles.value.view
        return view.rows if view else ()

    def _selected_name(self) -> str:
        vehicle = self._state.snapshot.vehicle
        return vehicle.name if vehicle else ""

    def _show_vehicles(self, view: VehiclesView | None) -> None:
        snapshot = self._state.snapshot
        selected = snapshot.vehicle.system if snapshot.vehicle else None
        known = {each.system for each in view.rows} if view else set()
        if self._cursor not in known or self._cursor == selected:
            self._cursor = None
        cursor = selected if self._cursor is None else self._cursor
        self._vehicles.show(VehicleTableValue(view, selected, cursor, snapshot.waiting or ""))
        more = f" of {len(known) + view.not_shown}" if view and view.not_shown else ""
        self._vehicles.border_subtitle = plain(f"{len(known)}{more} heard" if view and known else "")
        heading = snapshot.vehicle.heading if snapshot.vehicle else None
        self._where.show(build_where(view, selected, heading, ascii=self._state.ascii))

    def _show_links(self, view: LinksView | None) -> None:
        """Show the links with the cursor in sight, if it is in this panel."""
        indexes = [link.index for link in view.rows] if view else []
        if self._link not in indexes:
            self._link = indexes[0] if indexes else None
        cursor = self._link if self._chosen == LINKS_PANEL else None
        top, width, room = self._links.value.top, max(1, self._links.size.width), max(1, self._links.size.height - 1)
        if cursor is not None:
            self._links.show(LinkTableValue(view, top, cursor))
            line, last = self._links.line_of(cursor, width), self._links.wanted(width) - 1 - room
            top = max(0, min(line, max(top, line - room + 2), max(0, last)))
        self._links.show(LinkTableValue(view, top, cursor))

    def _lay_out(self) -> None:
        """Share the rows: all panels as they need it, else the chosen one gets the room."""
        width, wide = max(1, self.room.width - 2), self.room.width >= WIDE
        beside = BYTES_ROWS if wide and self.room.height >= TALL else 0
        wanted = (self._vehicles.wanted, self._links.wanted(width), max(beside, self._control.wanted))
        heights = share_rows(PanelHeights(wanted, least=(4, 3, 3)), self._chosen, self.room.height - CHROME_ROWS)
        self._where.display = self._bytes.display = wide
        for number, (place, height) in enumerate(zip(self._places, heights, strict=True)):
            self._panels[number].set_class(number == self._chosen, "-chosen")
            place.display = height > 0
            place.styles.height = height


def describe_links(view: LinksView) -> str:
    """Return how many links there are, and which have a problem: where the rows are few, they may be out of sight."""
    count, bad = len(view.rows), [each.name for each in view.rows if each.problem is not None]
    links = f"{count} link{'' if count == 1 else 's'}"
    return f"{links}, {len(bad)} with a problem: {', '.join(bad)}" if bad else links if count else ""
