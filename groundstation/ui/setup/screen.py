"""Setup screen: why the vehicle cannot be driven, and what to do; motor test, calibration, restart, report."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable

from textual import events
from textual.containers import Horizontal, Vertical
from textual.widget import Widget

from groundstation.actions import ACTIONS
from groundstation.doctor.report import format_report
from groundstation.intents.setup import RebootVehicle, RunChecks, StopMotorTest
from groundstation.ui.base.list_keys import rows_to_move
from groundstation.ui.base.save_file import save_text
from groundstation.ui.base.screen import LIST_ARROWS, ConsoleScreen, ScreenContext
from groundstation.ui.display.display_state import DisplayState, ScreenKey
from groundstation.ui.display.wrap import plain
from groundstation.ui.params.edit.pending import PendingChange
from groundstation.ui.params.kept import keep_params
from groundstation.ui.setup.calibration_keys import CalibrationKeys
from groundstation.ui.setup.chain import ChainPanel, ChainValue, counts
from groundstation.ui.setup.checks import ChecksPanel, ChecksValue, checks_age
from groundstation.ui.setup.lists import CALIBRATION_KEYS, CalibrationPanel, FactsPanel, ListValue, request_text
from groundstation.ui.setup.model import MOTOR_KEYS, SetupModel
from groundstation.ui.setup.motors import MotorsPanel, MotorsValue, frame_note
from groundstation.ui.terminal.key_parser import KeyRepeat
from groundstation.views.base import View, ViewRequest
from groundstation.views.doctor import DoctorRequest, DoctorRow, DoctorView, ParamFix, TerminalFacts

WIDE, WIDEST = 120, 180
"""Columns from which on there are further panels, and from which on these are wider."""

PING_STEP = 0.005
"""s in which the terminal's round trip is sent to the station: each other value is a request of its own."""


class SetupScreen(ConsoleScreen):
    """The chain over the motor test; beside them the checks, the calibrations and the vehicle where there is room."""

    CSS_PATH = "screen.tcss"
    KEYS = (
        ScreenKey("enter", "Do", "Do or open what the line under the cursor proposes", commands=True),
        ScreenKey("f", "Fix", "Make the proposed value of a parameter a pending change of the Params screen"),
        ScreenKey("c", "Check", "Let the vehicle run its pre-arm checks", commands=True),
        ScreenKey(
            "m",
            "Motors",
            "Motor test, wheels up: then hold 1 to 4; + and - change the strength, v reverses",
            commands=True,
        ),
        ScreenKey("B", "Reboot", "Restart the vehicle, after a question", commands=True),
        ScreenKey("S", "Report", "Save a report for a bug, without keys and public addresses"),
        ScreenKey("C", "Compass", "Calibrate the compass; W writes the result, x cancels", commands=True),
        ScreenKey("A", "Accel", "Calibrate the accelerometers in 6 positions; ENTER confirms each", commands=True),
        ScreenKey("H", "Level", "Calibrate the level", commands=True),
        ScreenKey("Y", "Gyro", "Calibrate the gyros, at rest", commands=True),
        ScreenKey("P", "Pressure", "Calibrate the pressure sensor", commands=True),
        ScreenKey("R", "Sticks", "Calibrate the RC sticks: ends and centres become pending parameters", commands=True),
    )

    def __init__(self, context: ScreenContext) -> None:
        super().__init__(context)
        self._model = SetupModel()
        self._params = keep_params(context)
        self._calibrations = CalibrationKeys(self, self._model, self._params)
        self._chain = ChainPanel(ChainValue(), id="chain")
        self._checks = ChecksPanel(ChecksValue(), id="checks")
        self._motors = MotorsPanel(MotorsValue(), id="motors")
        self._calibration = CalibrationPanel(ListValue(), id="calibration")
        self._facts = FactsPanel(ListValue(), id="facts")
        self._tested = ""
        """Key of the motor that was turned last."""

    # ---- what all screens define ----

    def compose_body(self) -> Iterable[Widget]:
        """Lay out the panels in two rows."""
        self._chain.add_class("-chosen")
        upper = (
            self.build_panel(self._chain, "doctor: why can I not drive"),
            self.build_panel(self._checks, "pre-arm checks"),
        )
        lower = (
            self.build_panel(self._motors, "motor test"),
            self.build_panel(self._calibration, "calibration"),
            self.build_panel(self._facts, "vehicle"),
        )
        return (Vertical(Horizontal(*upper, id="upper"), Horizontal(*lower, id="lower"), id="setup"),)

    def requests(self) -> tuple[ViewRequest, ...]:
        """Return the request with what the terminal tells."""
        trip = self._state.terminal_round_trip
        rounded = None if trip is None else round(trip / PING_STEP) * PING_STEP
        return (DoctorRequest(TerminalFacts(rounded)),)

    def show_view(self, view: View) -> None:
        """Show the chain."""
        if isinstance(view, DoctorView):
            for line in self._model.show(view):
                self.say(request_text(line))
            self._show()

    def show_body(self, now: DisplayState) -> None:
        """End the motor test that nobody uses."""
        self._model.expire(time.monotonic())
        self._show()

    def on_resize(self, event: events.Resize) -> None:
        """Choose the layout."""
        self.set_class(self.room.width >= WIDE, "-wide")
        self.set_class(self.room.width >= WIDEST, "-widest")

    @property
    def advice(self) -> str:
        """Return whether keys can drive."""
        return self._model.verdict

    # ---- keys ----

    def choose_panel_of(self, widget: Widget) -> tuple[str, str] | None:
        """Move in the chain. While motors are tested the mouse does nothing: any key would stop them."""
        return LIST_ARROWS if widget is self._chain and not self._model.testing else None

    def perform_key(self, event: events.Key) -> bool:
        """Handle the keys of this screen. While motors are tested every other key stops them first."""
        if event.key in MOTOR_KEYS:
            self._turn(event.key, repeat=isinstance(event, KeyRepeat))
            return True
        self._stop_motor()
        if isinstance(event, KeyRepeat) and event.key not in ("up", "down"):
            return True
        if rows := rows_to_move(event.key, self._chain.size.height):
            self._model.move(rows, self._chain.size.height)
        elif event.key in _ACTIONS:
            _ACTIONS[event.key](self)
        elif event.key in _CALIBRATIONS:
            self._calibrations.begin(_CALIBRATIONS[event.key])
        else:
            return False
        self._show()
        return True

    @property
    def marked_text(self) -> str:
        """The row of the chain under the cursor, with its advice."""
        row = self._model.selected
        return " · ".join(part for part in (f"{row.title}: {row.evidence}", row.advice) if part) if row else ""

    def release_key(self, key: str) -> None:
        """Stop the motor whose key was released."""
        if key in MOTOR_KEYS:
            self._stop_motor()

    def leave(self) -> None:
        """Stop the motor: its key is not seen any more."""
        self._stop_motor()
        self._model.testing = False

    # ---- the chain ----

    def _do(self) -> None:
        row = self._model.selected
        if self._calibrations.confirm():
            return
        if row is not None and row.action:
            self._perform(row)
        elif row is not None:
            self.say(row.advice or "nothing to do here")

    def _perform(self, row: DoctorRow) -> None:
        if row.action in _OWN:
            _OWN[row.action](self)
            return
        action = ACTIONS[row.action]
        if action.intent is not None:
            self.context.send(action.intent)
        else:
            self.context.perform(action)

    def _fix(self) -> None:
        row = self._model.selected
        if row is None or row.fix is None:
            self.say("no parameter helps here")
        else:
            self._propose(row.fix)

    def _propose(self, fix: ParamFix) -> None:
        view = self._model.view
        if view is not None:
            self._params.propose(view.system, PendingChange(fix.name, fix.before, fix.value))
            self.say(f"{fix.name} {fix.before:g} → {fix.value:g} is pending: F4, then W writes it")

    def _check(self) -> None:
        view = self._model.view
        if view is None or not view.system:
            self.say("no vehicle yet")
        else:
            self.context.send(RunChecks(self.context.numbers.take(), view.system))

    # ---- motors ----

    def _ask_for_motors(self) -> None:
        refusal = self._model.refuse_test()
        if refusal is not None:
            self.say(refusal)
        else:
            text = "motor test: WHEELS OFF THE GROUND, hands away; a held key turns a motor"
            self.ask(text, lambda: self._model.begin_test(time.monotonic()))

    def _turn(self, key: str, *, repeat: bool) -> None:
        if not self._model.testing:
            self.say("m begins a motor test")
            return
        intent = self._model.press_motor(key, time.monotonic(), repeat=repeat)
        if intent is None:
            self._stop_motor()
            self.say(f"there is no motor {key}")
            return
        self._tested = key
        self.context.send(intent)

    def _stop_motor(self) -> None:
        if self._model.testing:
            self.context.send(StopMotorTest())

    def _reverse(self) -> None:
        row = next((row for row in self._model.motors if str(row.number) == self._tested), None)
        if row is None or row.reversal is None:
            self.say("turn a motor first" if row is None else f"it is not known how {row.name} is reversed")
        else:
            self._propose(row.reversal)

    # ---- the vehicle ----

    def _reboot(self) -> None:
        view = self._model.view
        if view is None or not view.system:
            self.say("no vehicle yet")
            return
        intent = RebootVehicle(self.context.numbers.take(), view.system)
        self.ask(f"restart {view.name}", lambda: self.context.send(intent))

    def _save_report(self) -> None:
        view = self._model.view
        if view is None:
            self.say("nothing to save yet")
            return
        path = self.context.folder / time.strftime("doctor-%Y%m%d-%H%M%S.txt")
        log = (f"{line.label}: {line.text}" for line in self._state.snapshot.texts)
        problem = save_text(path, format_report(view, log=log))
        self.say(f"saved {path.name}" if problem is None else f"not saved: {problem}: {path.name}")

    # ---- parts ----

    def _show(self) -> None:
        """Show the model."""
        model, view = self._model, self._model.view
        selected = model.selected
        self._chain.show(ChainValue(model.rows, selected.id if selected else "", model.next_steps))
        self._chain.border_subtitle = plain(counts(model.rows))
        self._checks.show(ChecksValue(view))
        self._checks.border_subtitle = plain(checks_age(view) if view is not None else "")
        self._motors.show(MotorsValue(view, model.testing, model.strength))
        self._motors.border_subtitle = plain(frame_note(view))
        self._calibration.show(ListValue(view))
        self._facts.show(ListValue(view))


_ACTIONS: dict[str, Callable[[SetupScreen], None]] = {
    "enter": SetupScreen._do,
    "f": SetupScreen._fix,
    "c": SetupScreen._check,
    "m": SetupScreen._ask_for_motors,
    "plus": lambda screen: screen._model.change_strength(1),
    "minus": lambda screen: screen._model.change_strength(-1),
    "v": SetupScreen._reverse,
    "W": lambda screen: screen._calibrations.write(),
    "x": lambda screen: screen._calibrations.cancel(),
    "B": SetupScreen._reboot,
    "S": SetupScreen._save_report,
}
"""Key -> what it does; SetupScreen.KEYS has their names."""

_CALIBRATIONS = {key: kind for kind, key in CALIBRATION_KEYS.items()}
"""Key -> kind of calibration."""

_OWN: dict[str, Callable[[SetupScreen], None]] = {
    "setup.checks": SetupScreen._check,
    "setup.motors": SetupScreen._ask_for_motors,
}
"""Actions of rows that this screen performs itself."""
