"""A real rover without links, three ground stations and its surroundings, as small steps that a test can choose from.

A: a ground station with sessions. B: another one, without. T: a program with the ids of A, without sessions. S: a
stranger that has sent no HEARTBEAT. Every step ends with the checks of the oracle (oracle.py).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from msgspec.structs import replace

from dialects import messages as m
from dialects.axes import Axes, build_manual_control
from dialects.enums import Command, OperatorFlag, Result
from dialects.modes import Mode
from link.core import Peer, Received
from tests.vehicle.bench import BEAT, EVERYTHING
from tests.vehicle.field import TWIST, Field
from tests.vehicle.machine.oracle import Oracle
from tests.vehicle.missions import upload, way
from vehicle.params import Params
from vehicle.readings import Readings
from vehicle.rover import Rover

PARAMS = {"FS_GCS_TIMEOUT": 2.0, "FS_TIMEOUT": 0.5, "FS_DISARM_T": 5.0, "MOT_SLEWRATE": 1000.0,
          "BATT_LOW_VOLT": 11.0, "BATT_CRT_VOLT": 10.0}  # fmt: skip
"""The shortest times that parameters allow, so that few cycles make a long time."""
CYCLE = 0.09
"""s between two cycles: below LATE_CYCLE_TIME, so that no cycle is late."""
TALK = 0.18
"""s between two demands of a ground station that goes on talking."""
AHEAD, NEUTRAL = Axes(throttle=1.0), Axes()
ECHO_MAX = 0.45
"""OPR_ECHO_MAX."""
VOLTS = {"ok": 12.0, "low": 10.5, "critical": 9.0}


class Station(NamedTuple):
    """A sender of messages."""

    name: str
    system: int
    session: int | None = None
    introduced: bool = True

    @property
    def peer(self) -> Peer:
        """Where it is."""
        return Peer(0, self.name)


_ALL = (Station("A", 255, session=7), Station("B", 254), Station("T", 255), Station("S", 200, introduced=False))
STATIONS = {each.name: each for each in _ALL}
COMPONENT_ID = 190


@dataclass
class Surroundings:
    """What is not in the rover: the truth that the oracle goes by."""

    button: bool = False
    fault: bool = False
    battery: str = "ok"
    position: bool = True
    mission: bool = False
    """There is a mission to drive, and sensors to drive it by."""

    def readings(self) -> Readings:
        """Return what the sensors tell."""
        readings = replace(EVERYTHING, battery_voltage=VOLTS[self.battery])
        return readings if self.mission and self.position else replace(readings, latitude=None, longitude=None)


@dataclass
class Clocks:
    """What moves with every message and cycle."""

    now: float
    boot: float
    messages: int = 0
    proof: int = 0
    """Newest clock in a demand of A."""
    talk_due: float = 0.0


def build_rover(*, mission: bool) -> tuple[Rover, float]:
    """Return a rover in BOOT, or one with a mission and a known position in SAFE, and the time."""
    if not mission:
        return Rover(Params(PARAMS), now=100.0), 100.0
    field = Field(**PARAMS)  # type: ignore[arg-type]
    assert upload(field, way(3000, 0)) == 0
    return field.rover, field.now


class Rig:
    """`perform` runs one step by its name."""

    def __init__(self, *, mission: bool = False) -> None:
        self.rover, now = build_rover(mission=mission)
        self.clocks = Clocks(now, 100.0)
        self.around = Surroundings(mission=mission)
        self.oracle = Oracle(now)
        for station in ("A", "B", "T"):
            self.send(station, BEAT)
        self.wait(0.5)

    @property
    def now(self) -> float:
        """Virtual time."""
        return self.clocks.now

    # ---- what a ground station does ----

    def send(self, name: str, message: m.Message, *, good: bool = False, act: str = "") -> None:
        """Let the rover receive a message; `good`: it proves the session of its sender now."""
        station, clocks = STATIONS[name], self.clocks
        clocks.messages += 1
        self.oracle.before(self.rover, name, act, self.now, good=good)
        self.rover.receive(
            Received(message, station.system, COMPONENT_ID, clocks.messages % 256, station.peer, station.introduced,
                     numbering=1, digest=clocks.messages), self.now)  # fmt: skip
        self.oracle.after_message(self.rover, self._result(), self.around, self.now)

    def _result(self) -> Result | None:
        outgoing = self.rover._outbox._outgoing
        results = [Result(each.message.result) for each in outgoing if isinstance(each.message, m.CommandAck)]
        outgoing.clear()
        return results[-1] if results else None

    def command(self, name: str, act: str, command: int, *params: float) -> None:
        """Send a command; `act` is what it asks for, in the words of the oracle."""
        one, two, three, four, five, six, seven = (*params, *(0.0,) * (7 - len(params)))
        self.send(name, m.CommandLong(1, 1, command, 0, one, two, three, four, five, six, seven), act=act)

    def demand(self, name: str, axes: Axes, *, age: float = 0.02, clock: int | None = None) -> None:
        """Send a demand: a proof of a station with sessions whose echo is `age` s old, or MANUAL_CONTROL.

        `clock`: what the clock of its sender was, for one that comes late or twice.
        """
        act = "neutral" if axes == NEUTRAL else "ahead"
        session = STATIONS[name].session
        if session is None:
            self.send(name, build_manual_control(axes, 1), act=act)
            return
        kind = "proof" if age <= ECHO_MAX else "proof old"
        if clock is not None and clock <= self.clocks.proof:
            kind = "proof overtaken"
        self.clocks.proof = max(self.clocks.proof, clock or self.clocks.messages + 1)
        message = self._proof(session, axes, age, clock or self.clocks.messages + 1)
        self.send(name, message, good=age <= ECHO_MAX, act=f"{kind} {act}")

    def unproven(self, name: str, axes: Axes) -> None:
        """Send MANUAL_CONTROL, whatever the station."""
        self.send(name, build_manual_control(axes, 1), act="neutral" if axes == NEUTRAL else "ahead")

    def _proof(self, session: int, axes: Axes, age: float, clock: int) -> m.RoverOperatorPresence:
        echo = max(1, round((self.now - self.clocks.boot - age) * 1000))
        return m.RoverOperatorPresence(
            1, 1, clock, echo, session, 1, 0, OperatorFlag.AXES,
            round(axes.throttle * 1000), 0, 0, round(axes.steering * 1000))  # fmt: skip

    def setpoint(self, name: str) -> None:
        """Send a velocity for GUIDED."""
        message = m.SetPositionTargetLocalNed(0, 1, 1, 8, TWIST, 0, 0, 0, 1.0, 0, 0, 0, 0, 0, 0, 0.0)
        self.send(name, message, act="setpoint")

    def mode(self, name: str, mode: Mode) -> None:
        """Choose a mode."""
        self.command(name, f"mode {mode.name}", Command.DO_SET_MODE, 1, mode)

    # ---- what happens around the rover ----

    def cycle(self, gap: float = CYCLE) -> None:
        """Let `gap` s pass, and run one control cycle."""
        self.clocks.now += gap
        self.oracle.before(self.rover, "", "", self.now)
        self.rover.update_estop_input("pressed" if self.around.button else None, self.now)
        self.rover.sense(self.around.readings(), self.now)
        self.rover.tick(self.now)
        self.rover._outbox._outgoing.clear()
        self.oracle.after_cycle(self.rover, self.around, self.now, gap)

    def wait(self, seconds: float, talker: str = "", axes: Axes | None = None) -> None:
        """Let time pass; `talker` goes on with a demand."""
        for _ in range(round(seconds / CYCLE)):
            self.cycle()
            if talker and axes is not None and self.now >= self.clocks.talk_due:
                self.clocks.talk_due = self.now + TALK
                self.demand(talker, axes)

    def button(self, *, pressed: bool) -> None:
        """Press or release the emergency stop button."""
        self.around.button = pressed
        self.oracle.before(self.rover, "", "button", self.now)
        self.rover.update_estop_input("pressed" if pressed else None, self.now)
        self.oracle.after_cycle(self.rover, self.around, self.now, 0.0)

    def motor(self, *, works: bool) -> None:
        """Break or repair the motor driver."""
        self.around.fault = not works
        self.oracle.before(self.rover, "", "motor", self.now)
        self.rover.motor_repaired(self.now) if works else self.rover.motor_failed("broken", self.now)
        self.oracle.after_cycle(self.rover, self.around, self.now, 0.0)

    def battery(self, state: str) -> None:
        """Let the battery have been in a state for long enough."""
        self.around.battery = state
        self.rover._safety.battery.update(VOLTS[state], self.now - 20.0)
        self.cycle()

    def position(self, *, known: bool) -> None:
        """Lose the position, or find it again; the ground station in control goes on."""
        self.around.position = known
        self.wait(3.6 if not known else 0.3, "A", NEUTRAL)

    def shutdown(self) -> None:
        """End the program."""
        self.oracle.before(self.rover, "", "shutdown", self.now)
        self.rover.shutdown(self.now)
        self.oracle.after_cycle(self.rover, self.around, self.now, 0.0)
