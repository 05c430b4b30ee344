"""Pane of the Drive screen: one of PANES, with its name and those of the others in its border."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from msgspec.structs import replace
from textual.app import ComposeResult
from textual.containers import Vertical

from groundstation.ui.display.display_state import DisplayState
from groundstation.ui.display.wrap import plain
from groundstation.ui.drive.camera_feed import CameraFeed
from groundstation.ui.drive.instruments.camera import CameraPicture
from groundstation.ui.drive.panes import CAMERA, PANES, Pane, PaneInput
from groundstation.ui.map.plan.copies import PlanCopies
from groundstation.ui.widgets.instrument import Instrument
from groundstation.views.base import View, ViewRequest

CLOSER, WIDER = 1, -1


EARLY = 0.02
"""s by which an update may be early: snapshots that are due at the same time as it come a little early or late."""


class PaneFrame(Vertical, can_focus=False):
    """Shows the pane of one index. The zoom of each pane is kept while another one is shown."""

    def __init__(
        self,
        index: int,
        now: DisplayState,
        plans: PlanCopies,
        camera: CameraFeed,
        *,
        id: str,  # noqa: A002
    ) -> None:
        super().__init__(id=id)
        self._index = index
        self._plans = plans
        self._given = PaneInput(now, plans=plans, camera=camera)
        self._zooms = dict.fromkeys((pane.id for pane in PANES), 0)
        self._built: dict[str, Instrument[Any]] = {}
        self._due = 0.0

    def compose(self) -> ComposeResult:
        """Build all panes; only one of them is displayed."""
        for pane in PANES:
            self._built[pane.id] = pane.build(pane.value(self._given), id=f"{self.id}-{pane.id}")
            yield self._built[pane.id]

    def on_mount(self) -> None:
        """Show the first one."""
        self.turn_to(self._index)

    @property
    def pane(self) -> Pane:
        """The pane that is shown."""
        return PANES[self._index]

    @property
    def requests(self) -> tuple[ViewRequest, ...]:
        """Views that it needs."""
        return (*self.pane.requests, *(self._plans.requests if self.pane.wants_plans else ()))

    @property
    def index(self) -> int:
        """Which of PANES is shown."""
        return self._index

    @property
    def camera(self) -> CameraPicture | None:
        """The picture of the camera; None while another pane is shown."""
        shown = self._built.get(PANES[CAMERA].id)
        return shown if self._index == CAMERA and isinstance(shown, CameraPicture) else None

    @property
    def given(self) -> PaneInput:
        """What it draws from."""
        return self._given

    def turn_on(self) -> None:
        """Show the pane after this one."""
        self.turn_to(self._index + 1)

    def turn_to(self, index: int) -> None:
        """Show another pane."""
        self._index = index % len(PANES)
        for pane in PANES:
            self._built[pane.id].display = pane is self.pane
        self.border_title = plain(self.pane.id)
        self._draw()

    def set_hint(self, key: str) -> None:
        """Say which key shows which pane next."""
        following = PANES[(self._index + 1) % len(PANES)].id
        hint = plain(f"{key} {following}")
        if self.border_subtitle != hint.markup:
            self.border_subtitle = hint

    def zoom(self, step: int) -> None:
        """Zoom by a step, as far as the pane can."""
        low, high = self.pane.zooms
        self._zooms[self.pane.id] = max(low, min(high, self._zooms[self.pane.id] + step))
        self._draw()

    def show(self, now: DisplayState, views: Mapping[type[View], View]) -> None:
        """Show a display state, not more often than the pane wants."""
        self._given = replace(self._given, now=now, views=views)
        uptime = now.snapshot.uptime
        if 0 <= self._due - uptime <= self.pane.period:
            return
        self._due = uptime + self.pane.period - EARLY
        self._draw()

    def show_view(self, views: Mapping[type[View], View]) -> None:
        """Show what the station sent for it."""
        self._given = replace(self._given, views=views)
        self._draw()

    def _draw(self) -> None:
        given = replace(self._given, zoom=self._zooms[self.pane.id])
        if self.pane.id in self._built:
            self._built[self.pane.id].show(self.pane.value(given))
