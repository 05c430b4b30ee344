"""PlanIntents: the intents of the Map screen, each with its number and the vehicle that the operator sees."""

from __future__ import annotations

from groundstation.geo import Place
from groundstation.intents.plan import (
    ChooseMode,
    ClearPlan,
    DownloadPlan,
    EnableFence,
    GoTo,
    JumpToItem,
    PauseMission,
    SetHome,
    StartMission,
    UploadPlan,
)
from groundstation.intents.services import CancelRequest
from groundstation.intents.union import AnyIntent
from groundstation.ui.display.request_numbers import RequestNumbers
from groundstation.ui.map.plan.rows import Items
from groundstation.views.plan import PlanKind, PlanMode, PlanView


class PlanIntents:
    """Makes them for the vehicle of a view."""

    def __init__(self, numbers: RequestNumbers) -> None:
        self._numbers = numbers

    def download(self, view: PlanView, kind: PlanKind) -> AnyIntent:
        """Download a plan."""
        return DownloadPlan(self._numbers.take(), view.system, kind)

    def upload(self, view: PlanView, kind: PlanKind, items: Items) -> AnyIntent:
        """Replace a plan; home goes along where its altitude is known."""
        home = view.home if view.home_altitude is not None else None
        return UploadPlan(self._numbers.take(), view.system, kind, items, home, view.home_altitude or 0.0)

    def clear(self, view: PlanView, kind: PlanKind) -> AnyIntent:
        """Clear a plan on the vehicle."""
        return ClearPlan(self._numbers.take(), view.system, kind)

    def start(self, view: PlanView) -> AnyIntent:
        """Start the mission, or go on."""
        return StartMission(self._numbers.take(), view.system)

    def pause(self, view: PlanView) -> AnyIntent:
        """Pause the mission."""
        return PauseMission(self._numbers.take(), view.system)

    def jump(self, view: PlanView, index: int) -> AnyIntent:
        """Make a mission item the current one."""
        return JumpToItem(self._numbers.take(), view.system, index)

    def enable_fence(self, view: PlanView, *, on: bool) -> AnyIntent:
        """Switch the fence on or off."""
        return EnableFence(self._numbers.take(), view.system, on)

    def go_to(self, view: PlanView, place: Place) -> AnyIntent:
        """Drive to a place."""
        return GoTo(self._numbers.take(), view.system, place)

    def set_home(self, view: PlanView, place: Place) -> AnyIntent:
        """Move home to a place."""
        return SetHome(self._numbers.take(), view.system, place)

    def choose_mode(self, view: PlanView, mode: PlanMode) -> AnyIntent:
        """Change the mode."""
        return ChooseMode(self._numbers.take(), view.system, mode.name)

    def cancel(self, view: PlanView) -> tuple[AnyIntent, ...]:
        """Cancel the transfers that run."""
        return tuple(CancelRequest(line.number) for line in view.running)
