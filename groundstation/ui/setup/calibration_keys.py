"""The keys of the Setup screen that calibrate: what they ask, send and make pending."""

from __future__ import annotations

from groundstation.intents.setup import Calibrate, ConfirmPosition, EndCalibration, WatchSticks
from groundstation.ui.base.screen import ConsoleScreen
from groundstation.ui.params.edit.pending import PendingChange
from groundstation.ui.params.model import ParamModel
from groundstation.ui.setup.model import SetupModel
from groundstation.views.doctor import STICKS, CalibrationRow, DoctorView

NO_VEHICLE = "no vehicle yet"


class CalibrationKeys:
    """Acts for one screen; `params` gets the changes that a calibration of the sticks proposes."""

    def __init__(self, screen: ConsoleScreen, model: SetupModel, params: ParamModel) -> None:
        self._screen, self._model, self._params = screen, model, params

    def begin(self, name: str) -> None:
        """Ask, then begin the kind of this name, if the vehicle can."""
        view = self._model.view
        row = next((each for each in view.calibrations if each.kind.partition("-")[0] == name), None) if view else None
        if view is None or row is None or row.state == "cannot":
            self._screen.say("this vehicle cannot calibrate that" if row else NO_VEHICLE)
        elif row.kind == STICKS:
            self._begin_sticks(view, row)
        else:
            intent = Calibrate(self._screen.context.numbers.take(), view.system, row.kind)
            self._screen.ask(f"calibrate {row.title} of {view.name}", lambda: self._screen.context.send(intent))

    def _begin_sticks(self, view: DoctorView, row: CalibrationRow) -> None:
        if view.armed:
            self._screen.say("the vehicle is armed: disarm it before the sticks are calibrated")
        else:
            text = f"calibrate {row.title} of {view.name}: switch the transmitter on, no other station may drive"
            self._screen.ask(text, lambda: self._screen.context.send(WatchSticks(view.system)))

    def confirm(self) -> bool:
        """Confirm what a calibration waits for; return whether one does."""
        view = self._model.view
        if view is not None and view.waits_for_position:
            self._screen.context.send(ConfirmPosition(view.system))
        elif view is not None and view.sticks is not None:
            self._take_sticks(view)
        else:
            return False
        return True

    def _take_sticks(self, view: DoctorView) -> None:
        """Make the ends and centres pending; nothing is written."""
        if view.sticks_unread:
            self._screen.say(f"{view.sticks_unread[0]} is being read, press ENTER again")
            return
        if not any(row.moved for row in view.sticks or ()):
            self._screen.say("no stick was moved from end to end yet; x cancels")
            return
        changes = [PendingChange(each.name, each.before, each.value) for each in view.stick_changes]
        self._params.propose(view.system, *changes)
        self._screen.context.send(WatchSticks(view.system, on=False))
        pending = f"{len(changes)} changes are pending: F4, then W writes them"
        self._screen.say(pending if changes else "the sticks have the ends and centres that the vehicle knows")

    def write(self) -> None:
        """Write the result of the compass."""
        view = self._model.view
        if view is None or not view.compass_ready:
            self._screen.say("there is no result of a compass to write")
        else:
            self._end_compass(view, accept=True)

    def cancel(self) -> None:
        """Cancel the calibration of the sticks, else that of the compass."""
        view = self._model.view
        if view is None or not view.system:
            self._screen.say(NO_VEHICLE)
        elif view.sticks is not None:
            self._screen.context.send(WatchSticks(view.system, on=False))
        else:
            self._end_compass(view, accept=False)

    def _end_compass(self, view: DoctorView, *, accept: bool) -> None:
        context = self._screen.context
        context.send(EndCalibration(context.numbers.take(), view.system, accept))
