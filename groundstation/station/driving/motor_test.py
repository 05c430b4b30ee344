"""Motor test: one motor turns while its key is held, 2 s at most.

The vehicle gets requests of 0.5 s, renewed four times a second, and never a longer one: whatever ends this program also
ends the renewals, and the vehicle stops the motor by itself. A request is not repeated when its acknowledgement is
missing, because a late repeat would turn the motor after the key was released.

IDLE --key of a motor--> TURNING --release, another key, 2 s, lease, link, armed, refusal--> stop x3, IDLE
"""

from __future__ import annotations

import math

import msgspec

from dialects import messages as m
from dialects.enums import Autopilot, Command, Result, result_token
from groundstation.input.key_repeat import REPEAT_WINDOW_MAX, KeyTrace, RepeatWindows
from groundstation.intents.setup import TurnMotor
from groundstation.station.driving.operator import OperatorSession
from groundstation.station.outbox import StationOutbox
from groundstation.vehicles.fleet import Contact, Fleet
from groundstation.vehicles.readings.motor_outputs import TURN_TIME, TestedMotor, build_stop, build_turn, is_turn
from groundstation.views.doctor import MotorTestView
from link.core import Outgoing, Received

LONGEST = 2.0
"""s for which a motor turns, however long its key is held."""

RENEW_PERIOD = 0.25
"""s between two requests: one of them may get lost without an interruption."""

THROTTLE_MAX = 0.3
"""Largest throttle, as the limit of our rover (vehicle/drive/gate.py)."""

STOPS, STOP_PERIOD = 3, 0.1
"""How often a stop is sent, and s between."""

TIME_STEP, TIMES = 0.01, 10
"""Requests of one press and of the next differ by TIME_STEP s: a vehicle takes an equal one within 3 s for a repeat."""

ALONE = "release the key, then press it again"


class _Run(msgspec.Struct):
    """A motor that turns."""

    contact: Contact
    number: int
    motor: TestedMotor
    throttle: float
    began: float
    seconds: float
    """Time of each request."""
    trace: KeyTrace
    held_until: float
    """When the key counts as released; inf where the terminal reports releases."""
    due: float
    acknowledged: bool = False


class _Stop(msgspec.Struct):
    """Stops that are still to be sent."""

    contact: Contact
    motor: TestedMotor
    left: int
    due: float


class MotorTester:
    """Turns one motor at a time. `ids` are our system and component id."""

    def __init__(self, fleet: Fleet, operator: OperatorSession, outbox: StationOutbox, ids: tuple[int, int]) -> None:
        self._fleet, self._operator, self._ids = fleet, operator, ids
        self._windows = RepeatWindows()
        self._run: _Run | None = None
        self._stops: list[_Stop] = []
        self._outbox = outbox.commands
        self._presses = 0
        self._event_at = -math.inf
        self._text = ""
        self.tested: dict[int, frozenset[int]] = {}
        """System id -> numbers of the motors whose test was acknowledged."""

    @property
    def busy(self) -> bool:
        """A motor turns, or is being stopped."""
        return self._run is not None or bool(self._stops)

    @property
    def view(self) -> MotorTestView | None:
        """What the screen shows of the test."""
        if self._run is not None:
            return MotorTestView(self._run.number, f"turns at {self._run.throttle:+.0%}", turning=True)
        return MotorTestView(0, self._text, turning=False) if self._text else None

    # ---- the operator ----

    def press(self, intent: TurnMotor, motors: tuple[TestedMotor, ...], now: float) -> None:
        """Handle the key of a motor."""
        before, self._event_at = self._event_at, now
        if self._run is not None:
            self._hold(self._run, intent, now)
            return
        if intent.repeat or now - before < REPEAT_WINDOW_MAX:
            return  # still the key of a test that has ended
        contact = self._fleet.selected
        refusal = self._refusal(contact, intent, motors, now)
        if refusal is not None or contact is None:
            self._text = f"not turned: {refusal or 'no vehicle yet'}"
            return
        self._begin(contact, intent, motors[intent.motor - 1], now)

    def stop(self, text: str, now: float) -> None:
        """End the test that runs; nothing happens without one."""
        run, self._run = self._run, None
        if run is None:
            return
        self._text = text
        self._outbox[:] = [each for each in self._outbox if not is_turn(each.message)]
        self._stops.append(_Stop(run.contact, run.motor, STOPS, now))
        self._send_stops(now)

    def _hold(self, run: _Run, intent: TurnMotor, now: float) -> None:
        if intent.motor != run.number or intent.system != run.contact.state.system:
            self.stop(f"another key: {ALONE}", now)
        elif not self._operator.sticks.reports_releases:
            run.held_until = now + self._windows.record_repeat(run.trace, now)

    def _refusal(
        self, contact: Contact | None, intent: TurnMotor, motors: tuple[TestedMotor, ...], now: float
    ) -> str | None:
        """Return why no motor may turn."""
        if contact is None:
            return "no vehicle yet"
        state = contact.state
        if intent.system != state.system:
            return "another vehicle was selected meanwhile"
        if not self._operator.live:
            return "screen not responding"
        if not state.monitor.is_alive(now):
            return "link lost"
        if state.emergency_stop:
            return "emergency stop"
        if state.armed:
            return "the vehicle is armed"
        if not 1 <= intent.motor <= len(motors):
            return f"there is no motor {intent.motor}"
        return None if abs(intent.throttle) <= THROTTLE_MAX else f"more than {THROTTLE_MAX:.0%}"

    def _begin(self, contact: Contact, intent: TurnMotor, motor: TestedMotor, now: float) -> None:
        self._presses += 1
        self._stops = [stop for stop in self._stops if stop.contact is not contact]  # they would end this test
        trace = RepeatWindows.start_press(None, now)
        exact = self._operator.sticks.reports_releases
        self._run = _Run(
            contact,
            intent.motor,
            motor,
            intent.throttle,
            began=now,
            seconds=TURN_TIME - TIME_STEP * (self._presses % TIMES),
            trace=trace,
            held_until=math.inf if exact else now + self._windows.press_window,
            due=now,
        )
        self.tick(now)

    # ---- core ----

    def receive(self, received: Received, now: float) -> None:
        """Handle the answer to a request."""
        run, message = self._run, received.message
        if run is None or not isinstance(message, m.CommandAck) or received.system != run.contact.state.system:
            return
        if message.target_system not in (0, self._ids[0]) or message.command not in (
            Command.ACTUATOR_TEST, Command.DO_MOTOR_TEST
        ):  # fmt: skip
            return
        if message.result == Result.ACCEPTED:
            run.acknowledged = True
            system = received.system
            self.tested[system] = self.tested.get(system, frozenset()) | {run.number}
        elif message.result != Result.IN_PROGRESS:
            self.stop(f"refused: {result_token(message.result)}", now)

    def handle_text(self, text: str, now: float) -> None:
        """Add the vehicle's reason to a refusal that has just been shown."""
        if self._text.startswith("refused") and ":" not in self._text.partition(":")[2]:
            self._text += f": {text}"

    def tick(self, now: float, *, watched: bool = True) -> None:
        """Renew the request, or end the test. `watched`: the Setup screen is shown."""
        run = self._run
        if run is not None:
            end = self._end(run, now, watched=watched)
            if end is not None:
                self.stop(end, now)
            elif now >= run.due:
                run.due = now + RENEW_PERIOD
                self._send(run.contact, *build_turn(run.contact.state.autopilot, run.motor, run.throttle, run.seconds))
        self._send_stops(now)

    def _end(self, run: _Run, now: float, *, watched: bool) -> str | None:
        """Return why the test ends now."""
        state = run.contact.state
        if not self._operator.live or not watched:
            return "stopped: the screen was left" if self._operator.live else "stopped: screen not responding"
        if run.contact is not self._fleet.selected or not state.monitor.is_alive(now):
            return "stopped: the vehicle is gone"
        if now >= run.held_until:
            return f"stood after {now - run.began:.1f} s"
        if now - run.began >= LONGEST:
            return f"stopped after {LONGEST:g} s: {ALONE}"
        arms_itself = state.autopilot == Autopilot.ARDUPILOT and run.acknowledged
        return "stopped: the vehicle is armed" if state.armed and not arms_itself else None

    def _send_stops(self, now: float) -> None:
        for stop in self._stops:
            if now >= stop.due:
                stop.left, stop.due = stop.left - 1, now + STOP_PERIOD
                self._send(stop.contact, *build_stop(stop.contact.state.autopilot, stop.motor))
        self._stops = [stop for stop in self._stops if stop.left]

    def _send(self, contact: Contact, command: Command, params: tuple[float, ...]) -> None:
        target = (contact.state.system, contact.state.component)
        self._outbox.append(Outgoing(m.CommandLong(*target, command, 0, *params)))
