"""MapModel: what the Map screen shows and edits. Knows no widget, no clock and no file."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

from groundstation.formats.layer import LayerDocument
from groundstation.geo import LocalFrame, Place, Point
from groundstation.intents.union import AnyIntent
from groundstation.ui.display.request_numbers import RequestNumbers
from groundstation.ui.display.tab_marks import TabMark
from groundstation.ui.keys.mode_keys import MODE_KEYS
from groundstation.ui.look.colours import BLUE
from groundstation.ui.map.draw.ground import Ground
from groundstation.ui.map.draw.layers import MapLayers, describe_layer
from groundstation.ui.map.draw.scene import Route, find_reference, find_route
from groundstation.ui.map.plan.checks import plan_fault
from groundstation.ui.map.plan.copies import PlanCopies
from groundstation.ui.map.plan.editor import PlanEditor
from groundstation.ui.map.plan.geometry import place_of
from groundstation.ui.map.plan.plan_intents import PlanIntents
from groundstation.ui.map.plan.rows import Items
from groundstation.ui.map.plan.table_filter import TableFilter
from groundstation.views.base import View, ViewRequest
from groundstation.views.plan import PlanDocument, PlanKind, PlanMode, PlanView
from groundstation.views.requests import RequestLine

NEAR = 3.0
"""Cells within which ENTER takes the item under the cursor."""
BAR = 10
"""Cells of a progress bar."""
PLAN_NAMES = {PlanKind.MISSION: "mission", PlanKind.FENCE: "fence", PlanKind.RALLY: "rally points"}
NO_CURSOR = "no position: the map has no cursor"


class MapModel:
    """The newest views, the plans that are edited, and the ground."""

    SCREEN: ClassVar[str] = "map"

    def __init__(self, numbers: RequestNumbers) -> None:
        self.copies = PlanCopies()
        self.editor = PlanEditor()
        self.ground = Ground()
        self.intents = PlanIntents(numbers)
        self.layers = MapLayers()
        self.filter = TableFilter()
        self.replay = False
        """The views are of a log: nothing can be requested."""
        self.fence_off = False
        """The vehicle's fence is switched off, as its parameters say."""
        self.file = ""
        """Name of the file that was opened or saved last."""
        self._asked: set[int] = set()
        """Systems whose plans were requested by opening the screen."""
        self._asked_fence = 0
        """Number of the newest upload of a fence that was answered for."""
        self._told = 0
        """Number of the newest request whose end was shown."""
        self._route: tuple[object, Route] | None = None

    def tab_mark(self) -> TabMark | None:
        """Return a pencil while a plan is not as on the vehicle."""
        return TabMark("✎", BLUE) if self.editor.edited else None

    # ---- views ----

    @property
    def view(self) -> PlanView | None:
        """The newest view."""
        return self.copies.view

    @property
    def requests(self) -> tuple[ViewRequest, ...]:
        """The views to request."""
        return self.copies.requests

    def show_view(self, view: View) -> tuple[AnyIntent, ...]:
        """Show a view; return the intents that follow: plans that are not known are downloaded once."""
        before, known = self.view.system if self.view is not None else None, set(self.copies.items)
        whole = self.copies.show_view(view)
        if isinstance(view, PlanView) and before not in (None, view.system):
            self.editor = PlanEditor()
            self.ground.reset()
        for kind in known - self.copies.items.keys():
            self.editor.load_base(kind, ())
        if whole is not None:
            self.editor.load_base(whole, self.copies.items[whole])
        self.settle()
        return self._download_once(view) if isinstance(view, PlanView) else ()

    def settle(self) -> None:
        """Compute anew what follows from views and edits: the map's metres, the vehicle on it, a first cursor."""
        view, ground = self.view, self.ground
        reference = find_reference(view, [self.editor.items(kind) for kind in PlanKind]) or self.layers.place
        ground.frame = None if reference is None else LocalFrame(reference)
        ground.vehicle = self._to_point(view.place if view is not None else None)
        if ground.cursor is None:
            ground.cursor = (view.place if view is not None else None) or reference

    def _download_once(self, view: PlanView) -> tuple[AnyIntent, ...]:
        if view.system in self._asked:
            return ()
        self._asked.add(view.system)
        return tuple(self.intents.download(view, kind) for kind in PlanKind if not view.plans[kind].version)

    # ---- the ground ----

    def _to_point(self, place: Place | None) -> Point | None:
        frame = self.ground.frame
        return None if frame is None or place is None else frame.to_point(place)

    @property
    def home(self) -> Point | None:
        """Home on the map."""
        return self._to_point(self.view.home if self.view is not None else None)

    @property
    def route(self) -> Route:
        """The places of the mission; computed anew only when the mission, the map or home has changed."""
        rows, frame, home = self.editor.rows(PlanKind.MISSION), self.ground.frame, self.home
        if self._route is None or self._route[0] != (id(rows), frame, home):
            items = self.editor.items(PlanKind.MISSION)
            route = find_route(items, frame, home) if frame is not None else Route()
            self._route = (id(rows), frame, home), route
        return self._route[1]

    @property
    def shown_rows(self) -> Sequence[int]:
        """Indices of the rows of the edited plan that the table shows."""
        return self.filter.rows(self.editor, self.first)

    @property
    def hides_selected(self) -> bool:
        """The table has items, and the selected one is not among those that are shown."""
        return self.editor.row is not None and self.editor.selected not in self.shown_rows

    def set_filter(self, text: str) -> None:
        """Show only the rows of the table with these words; select the first if the selected one is not among them."""
        self.filter.text = text
        rows = self.shown_rows
        if rows and self.editor.selected not in rows:
            self.editor.select(rows[0])

    def select(self, by: int) -> None:
        """Select another row of the table; the cursor goes there."""
        rows, selected = self.shown_rows, self.editor.selected
        at = (rows.index(selected) if selected in rows else 0) + by
        if rows:
            self.editor.select(rows[max(0, min(len(rows) - 1, at))])
        row = self.editor.row
        place = place_of(row.item) if row is not None else None
        self.ground.cursor = place or self.ground.cursor

    def take_under_cursor(self) -> None:
        """Select the item under the cursor, if there is one."""
        cursor, found = self.ground.cursor_point, []
        for index, row in enumerate(self.editor.rows()):
            point = self._to_point(place_of(row.item))
            if point is not None and cursor is not None:
                found.append((math.dist(point, cursor), index))
        if found and min(found)[0] <= NEAR * 2 * self.ground.window.scale:
            self.editor.select(min(found)[1])

    # ---- edits ----

    def add(self) -> str | None:
        """Add an item at the cursor; return why that cannot be done."""
        return NO_CURSOR if self.ground.cursor is None else self.editor.add(self.ground.cursor)

    def new_polygon(self) -> str | None:
        """Begin another polygon of the fence at the cursor; return why that cannot be done."""
        if self.ground.cursor is None:
            return NO_CURSOR
        return self.editor.start_polygon(self.ground.cursor)

    def move_here(self) -> str | None:
        """Move the selected item to the cursor; return why that cannot be done."""
        return NO_CURSOR if self.ground.cursor is None else self.editor.move_to(self.ground.cursor)

    def take_file(self, document: PlanDocument, name: str) -> str:
        """Load the plans of a file that are not empty; return what came."""
        plans: dict[PlanKind, Items] = {kind: document.plans[kind] for kind in PlanKind if document.plans[kind]}
        if not plans:
            return f"{name}: no plan in it"
        self.editor.take_file(plans)
        self.file = name
        self.ground.fit()
        self.settle()
        found = ", ".join(f"{PLAN_NAMES[kind]} of {len(items)}" for kind, items in plans.items())
        return f"{name}: {found} · U uploads the {self.plan_name}"

    def take_layer(self, document: LayerDocument, name: str) -> str:
        """Show the shapes of a file; return what came."""
        self.layers.add(name, document)
        self.ground.fit()
        self.settle()
        return describe_layer(name, document, self.ground.frame)

    @property
    def document(self) -> PlanDocument:
        """The plans as a file has them."""
        view, items = self.view, [self.editor.items(kind) for kind in PlanKind]
        home, altitude = (view.home, view.home_altitude or 0.0) if view is not None else (None, 0.0)
        return PlanDocument((items[0], items[1], items[2]), home, altitude)

    # ---- requests ----

    @property
    def plan_name(self) -> str:
        """The plan that is edited."""
        return PLAN_NAMES[self.editor.layer]

    @property
    def first(self) -> int:
        """Number of the first item of the edited plan."""
        return self.view.first if self.view is not None and self.editor.layer is PlanKind.MISSION else 0

    @property
    def upload_fault(self) -> str | None:
        """Why the edited plan cannot be uploaded, or None."""
        if self.view is None:
            return "no vehicle yet"
        if any(line.what.startswith(f"upload {self.plan_name}") for line in self.view.running):
            return f"the {self.plan_name} is being uploaded"
        if not self.editor.rows():
            return f"there is nothing to upload; X clears the {self.plan_name} on the vehicle"
        return plan_fault(self.editor.items(self.editor.layer), self.first)

    def upload(self) -> tuple[AnyIntent, ...]:
        """Replace the edited plan on the vehicle."""
        view, layer = self.view, self.editor.layer
        return () if view is None else (self.intents.upload(view, layer, self.editor.items(layer)),)

    def download(self) -> tuple[AnyIntent, ...]:
        """Download the edited plan; edits of it are dropped, and undo has them back."""
        if self.view is None:
            return ()
        self.editor.revert(self.editor.layer)
        return (self.intents.download(self.view, self.editor.layer),)

    def mode_of(self, digit: str) -> PlanMode | None:
        """Return the mode of a digit, if the vehicle has it."""
        modes = {mode.name.upper(): mode for mode in (self.view.modes if self.view is not None else ())}
        return next((modes[name] for name in MODE_KEYS.get(digit, ()) if name in modes), None)

    # ---- status ----

    def pop_news(self) -> str | None:
        """Return how the newest request has ended, once; None if that was shown already."""
        line = self.view.ended[-1] if self.view is not None and self.view.ended else None
        if line is None or line.number == self._told:
            return None
        self._told = line.number
        return _ended_text(line)

    @property
    def fence_idle(self) -> bool:
        """A fence is on the vehicle, and it is switched off."""
        return self.fence_off and self.view is not None and self.view.plans[PlanKind.FENCE].count > 0

    def pop_fence_upload(self) -> bool:
        """Return whether the newest request that has ended is an upload of a fence, once for each."""
        line = self.view.ended[-1] if self.view is not None and self.view.ended else None
        if line is None or line.number == self._asked_fence or line.state != "accepted":
            return False
        if not line.what.startswith(f"upload {PLAN_NAMES[PlanKind.FENCE]}"):
            return False
        self._asked_fence = line.number
        return True

    @property
    def status(self) -> str:
        """What runs, what somebody else has changed, and what was refused last; one line."""
        view = self.view
        if view is None:
            return ""
        if view.running:
            return " · ".join(map(_running_text, view.running[:2]))
        for kind in PlanKind:
            if view.plans[kind].changed:
                return f"the {PLAN_NAMES[kind]} on the vehicle has changed · D downloads it"
        last = view.ended[-1] if view.ended else None
        told = last is None or last.state == "accepted" or last.what.startswith("download")  # the table names those
        return "" if last is None or told else _ended_text(last)


def _running_text(line: RequestLine) -> str:
    if line.total is None:
        return f"{line.what} ..."
    filled = round(BAR * line.done / line.total) if line.total else BAR
    return f"{line.what} {line.done}/{line.total} {'█' * filled}{'░' * (BAR - filled)}"


def _ended_text(line: RequestLine) -> str:
    """Return how a request ended; a failure begins with the reason, which must be seen on a narrow screen, too."""
    if line.state == "accepted":
        return f"{line.what}: {line.detail or 'done'}"
    again = " · U uploads it again" if line.what.startswith("upload") else ""
    return f"{line.state}: {line.detail}, {line.what}{again}" if line.detail else f"{line.what}: {line.state}{again}"
