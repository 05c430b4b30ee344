"""What the Setup screen shows: the view, the row under the cursor, and whether keys turn motors. Knows no widget."""

from __future__ import annotations

import msgspec

from groundstation.intents.setup import TurnMotor
from groundstation.intents.union import AnyIntent
from groundstation.views.doctor import DoctorRow, DoctorView, MotorRow
from groundstation.views.requests import RequestLine
from link.runtime.diagnosis import Health

STRENGTH, STRENGTH_STEP, LEAST = 0.12, 0.02, 0.04
"""Throttle of a motor test, its step and its least value: 12 % turns most motors, and a wheel in the air slowly."""

TEST_PATIENCE = 30.0
"""s without a key of a motor after which they turn nothing any more."""

MOTOR_KEYS = "1234"


class ChainLine(msgspec.Struct, frozen=True):
    """A line of the chain: one row, or a run of rows that are well."""

    rows: tuple[DoctorRow, ...]

    @property
    def row(self) -> DoctorRow:
        """The only row, or the last of the run."""
        return self.rows[-1]


def chain_lines(rows: tuple[DoctorRow, ...], room: int) -> tuple[ChainLine, ...]:
    """Return the rows as lines; where the room is too small, the first rows that are well share a line."""
    single = tuple(ChainLine((row,)) for row in rows)
    if len(single) <= room:
        return single
    lines: list[ChainLine] = []
    surplus = len(single) - room
    for row in rows:
        last = lines[-1].row if lines else None
        if surplus > 0 and last is not None and row.health is Health.OK and last.health is Health.OK:
            lines[-1] = ChainLine((*lines[-1].rows, row))
            surplus -= 1
        else:
            lines.append(ChainLine((row,)))
    return tuple(lines)


class SetupModel:
    """Lives as long as the screen."""

    def __init__(self) -> None:
        self.view: DoctorView | None = None
        self.strength = STRENGTH
        self.testing = False
        """Keys 1 to 4 turn motors."""
        self._selected = ""
        """Id of the row under the cursor; "": the first that needs something."""
        self._test_until = 0.0

    # ---- the chain ----

    def show(self, view: DoctorView) -> tuple[RequestLine, ...]:
        """Show a view; return the requests that have ended since the one before.

        For another vehicle, or none, the keys turn no motors any more.
        """
        known = None if self.view is None else {line.number: line.state for line in self.view.requests}
        if self.view is not None and view.system != self.view.system:
            self.testing = False
        self.testing = self.testing and bool(view.system)
        self.view = view
        self.strength = min(self.strength, view.motor_limit) if view.motor_limit else self.strength
        ended = (line for line in view.requests if line.state != "running")
        return tuple(line for line in ended if known is not None and known.get(line.number, "running") == "running")

    @property
    def rows(self) -> tuple[DoctorRow, ...]:
        """The chain."""
        return self.view.rows if self.view is not None else ()

    @property
    def selected(self) -> DoctorRow | None:
        """The row under the cursor: without a choice the first that stops the operator, else the first to look at."""
        chosen = next((row for row in self.rows if row.id == self._selected), None)
        if chosen is not None:
            return chosen
        worst = (row for health in (Health.FAULT, Health.WARNING) for row in self.rows if row.health is health)
        return next(worst, self.rows[0] if self.rows else None)

    def move(self, steps: int, room: int) -> None:
        """Move the cursor by so many lines."""
        lines, current = chain_lines(self.rows, room), self.selected
        if not lines or current is None:
            return
        at = next((index for index, line in enumerate(lines) if current in line.rows), 0)
        self._selected = lines[max(0, min(len(lines) - 1, at + steps))].row.id

    @property
    def next_steps(self) -> tuple[str, ...]:
        """What to do, in the order of the chain: what stops the operator first."""
        wanted = (row for health in (Health.FAULT, Health.WARNING) for row in self.rows if row.health is health)
        return tuple(f"{row.title}: {row.advice}" for row in wanted if row.advice)

    @property
    def verdict(self) -> str:
        """One line: whether keys can drive, and what is in the way."""
        view = self.view
        if view is None:
            return "waiting for the station"
        if not view.system and not view.faults:
            return "no vehicle yet: switch it on, and check address and power"
        if view.faults:
            names = ", ".join(row.title for row in view.faults)
            return f"You cannot drive yet: {names} · the same list: mavhelm doctor"
        return "Nothing stops you" + ("" if view.armed else " · arm on Drive")

    # ---- motors ----

    @property
    def motors(self) -> tuple[MotorRow, ...]:
        """The motors that can be tested."""
        return self.view.motors if self.view is not None else ()

    def refuse_test(self) -> str | None:
        """Return why no motor can be tested."""
        view = self.view
        if view is None or not view.system:
            return "no vehicle yet"
        if view.armed:
            return "the vehicle is armed: disarm it before a motor test"
        if not view.motors:
            return "it is not known which motors this vehicle has"
        return "MOT_TEST_MAX is 0: this vehicle allows no motor test" if view.motor_limit <= 0 else None

    def begin_test(self, now: float) -> None:
        """Let keys turn motors."""
        self.testing, self._test_until = True, now + TEST_PATIENCE

    def expire(self, now: float) -> None:
        """End the test mode when no motor key was pressed for long."""
        self.testing = self.testing and now < self._test_until

    def press_motor(self, key: str, now: float, *, repeat: bool) -> AnyIntent | None:
        """Return the intent of a motor's key; None for a motor that is not there."""
        number = int(key)
        if self.view is None or not 1 <= number <= len(self.motors):
            return None
        self._test_until = now + TEST_PATIENCE
        return TurnMotor(system=self.view.system, motor=number, throttle=self.strength, repeat=repeat)

    def change_strength(self, steps: int) -> None:
        """Change the throttle of the next test."""
        limit = self.view.motor_limit if self.view is not None else STRENGTH
        self.strength = round(max(LEAST, min(limit, self.strength + steps * STRENGTH_STEP)), 2)
