"""Keys of the Map screen that go to the vehicle: upload, download, clear, start, pause, jump, go to, home, modes.

What makes a vehicle move, or changes what an armed one does, asks first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, Protocol

from groundstation.intents.union import AnyIntent
from groundstation.snapshot import VehicleView
from groundstation.ui.keys.mode_keys import MODE_KEYS
from groundstation.ui.map.model import MapModel
from groundstation.ui.map.picture import title_of, way_text
from groundstation.ui.map.plan.rows import item_key
from groundstation.views.plan import PlanKind, PlanView

NOT_TOLD, ACTIVE, PAUSED = 0, 3, 4
"""MISSION_STATE."""
MISSION_MODES = MODE_KEYS["3"]


class Asking(Protocol):
    """What these keys need of a screen."""

    def send(self, intents: Iterable[AnyIntent]) -> None:
        """Send intents to the station."""

    def say(self, text: str | None) -> None:
        """Show a note."""

    def ask(self, text: str | Callable[[], str], perform: Callable[[], None], *, word: str = "") -> None:
        """Ask before an action."""


class DriveKeys:
    """`vehicle` returns the selected vehicle of the newest snapshot."""

    def __init__(self, screen: Asking, model: MapModel, vehicle: Callable[[], VehicleView | None]) -> None:
        self._screen = screen
        self._model = model
        self._vehicle = vehicle

    @property
    def advice(self) -> str:
        """What the vehicle does by itself, and what stops it."""
        vehicle = self._vehicle()
        if vehicle is None or not vehicle.armed or vehicle.drivable:
            return ""
        if self._drives_mission:
            return f"{vehicle.mode} follows the mission: SPACE holds it where it is, P pauses it"
        return f"{vehicle.mode} · P goes on with the mission" if self._paused else ""

    def perform(self, key: str) -> bool:
        """Handle a key; return False for any other."""
        action = _ACTIONS.get(key)
        if action is None:
            return False
        view = self._model.view
        if view is None:
            self._screen.say("no vehicle yet")
        else:
            action(self, view)
        return True

    def choose_mode(self, digit: str) -> None:
        """Change to the mode of a digit; one that moves by itself asks."""
        mode, view = self._model.mode_of(digit), self._model.view
        if mode is None or view is None:
            self._screen.say(f"this vehicle has no mode {' or '.join(MODE_KEYS[digit][:2])}")
        elif mode.moves:
            self._ask(f"change to {mode.name}, in which the vehicle moves by itself", view,
                      lambda: (self._model.intents.choose_mode(view, mode),))  # fmt: skip
        else:
            self._screen.send((self._model.intents.choose_mode(view, mode),))

    # ---- keys ----

    def _upload(self, view: PlanView) -> None:
        model, vehicle = self._model, self._vehicle()
        if fault := model.upload_fault:
            self._screen.say(f"not uploaded: {fault}")
        elif vehicle is not None and vehicle.armed:
            diff = model.editor.diff(model.editor.layer)
            what = f"upload the {model.plan_name} ({diff.text or 'no change'}) while {vehicle.name} is ARMED"
            self._ask(what, view, model.upload)
        else:
            self._screen.send(model.upload())

    def _download(self, view: PlanView) -> None:
        model, diff = self._model, self._model.editor.diff(self._model.editor.layer)
        if diff.count:
            text = f"download the {model.plan_name}: {diff.text} here are dropped (u has them back)"
            self._ask(text, view, model.download)
        else:
            self._screen.send(model.download())

    def _clear(self, view: PlanView) -> None:
        kind, name = self._model.editor.layer, self._model.plan_name
        self._ask(f"clear the {name} on {view.name}", view, lambda: (self._model.intents.clear(view, kind),))

    def _cancel(self, view: PlanView) -> None:
        if not view.running:
            self._screen.say("nothing runs that can be cancelled")
        self._screen.send(self._model.intents.cancel(view))

    def _start_or_pause(self, view: PlanView) -> None:
        if self._drives_mission:
            self._screen.send((self._model.intents.pause(view),))
            return
        if self._is_disarmed():
            return
        edited = bool(self._model.editor.diff(PlanKind.MISSION).count)
        edits = ", as the vehicle has it: the edits are not uploaded" if edited else ""
        text = "go on with the mission" if self._paused else "start the mission"
        edits += "; the fence is OFF" if self._model.fence_idle else ""
        self._ask(f"{text}: {view.name} drives by itself{edits}", view, lambda: (self._model.intents.start(view),))

    def _is_disarmed(self) -> bool:
        """Return whether the vehicle could not obey, and say what to do first."""
        vehicle = self._vehicle()
        if vehicle is None or vehicle.armed:
            return False
        self._screen.say(f"{vehicle.name} is disarmed: arm it first, on Drive")
        return True

    def ask_for_fence(self) -> None:
        """Offer to switch on a fence that has been uploaded."""
        if (view := self._model.view) is not None:
            text = "the fence is on the vehicle, but switched off: switch it on"
            self._ask(text, view, lambda: (self._model.intents.enable_fence(view, on=True),))

    def _switch_fence(self, view: PlanView) -> None:
        if self._model.fence_off:
            self._screen.send((self._model.intents.enable_fence(view, on=True),))
        else:
            text = f"switch the fence off: nothing keeps {view.name} inside it"
            self._ask(text, view, lambda: (self._model.intents.enable_fence(view, on=False),))

    def _jump(self, view: PlanView) -> None:
        model, at = self._model, self._model.editor.selected
        row = model.editor.row
        if model.editor.layer is not PlanKind.MISSION or row is None:
            self._screen.say("J needs an item of the mission: e chooses the mission")
        elif row.origin is None:
            self._screen.say("this item is not on the vehicle yet: U uploads it")
        else:
            origin = row.origin
            self._ask(f"jump to item {title_of(model, at)}", view, lambda: (model.intents.jump(view, origin),))

    def _go_to(self, view: PlanView) -> None:
        place = self._model.ground.cursor
        if place is None or self._model.ground.vehicle is None:
            self._screen.say("no position: the vehicle does not know where it is")
            return
        if self._is_disarmed():
            return
        way = way_text(self._model.ground.vehicle, self._model.ground.cursor_point)
        text = f"{view.name} drives to the cursor, {way}"
        self._ask(text, view, lambda: (self._model.intents.go_to(view, place),))

    def _set_home(self, view: PlanView) -> None:
        place = self._model.ground.cursor
        if place is None:
            self._screen.say("no position: the map has no cursor")
            return
        text = (
            f"move home to the cursor, {way_text(self._model.home, self._model.ground.cursor_point)} from where it is"
        )
        self._ask(text, view, lambda: (self._model.intents.set_home(view, place),))

    # ---- parts ----

    @property
    def _drives_mission(self) -> bool:
        vehicle, view = self._vehicle(), self._model.view
        auto = vehicle is not None and vehicle.armed and vehicle.mode.upper() in MISSION_MODES
        return auto and view is not None and view.state in (NOT_TOLD, ACTIVE)

    @property
    def _paused(self) -> bool:
        view = self._model.view
        return view is not None and view.state == PAUSED

    def _ask(self, text: str, view: PlanView, perform: Callable[[], Iterable[AnyIntent]]) -> None:
        """Ask; what has changed meanwhile, the vehicle or the plan (a file was opened), is not what was asked for."""
        plan = self._plan_keys()

        def answer() -> None:
            newest = self._model.view
            if newest is None or newest.system != view.system:
                self._screen.say("another vehicle is selected: nothing was sent")
            elif self._plan_keys() != plan:
                self._screen.say("the plan has changed meanwhile: nothing was sent")
            else:
                self._screen.send(perform())

        self._screen.ask(text, answer)

    def _plan_keys(self) -> list[tuple[Any, ...]]:
        """Return what an upload of the edited plan would send; the vehicle's copy, when it is read back, is equal."""
        return [item_key(item) for item in self._model.editor.items(self._model.editor.layer)]


_ACTIONS: dict[str, Callable[[DriveKeys, PlanView], None]] = {
    "U": DriveKeys._upload,
    "D": DriveKeys._download,
    "X": DriveKeys._clear,
    "C": DriveKeys._cancel,
    "P": DriveKeys._start_or_pause,
    "J": DriveKeys._jump,
    "G": DriveKeys._go_to,
    "F": DriveKeys._switch_fence,
    "H": DriveKeys._set_home,
}
"""Key -> what it does with the newest view."""
