"""A scripted mind and motors that remember, to see what the machine between them does."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from dialects.messages import Heartbeat
from link.core import LinkReport, Outgoing, Peer, Received
from vehicle.control_loop import ControlLoop
from vehicle.drive.gate import Outputs
from vehicle.motors.simulated import SimulatedMotors
from vehicle.readings import Readings
from vehicle.sensors import NoSensors

OFF = Outputs((0.0, 0.0), enabled=False)
AHEAD = Outputs((0.5, 0.4), enabled=True)
TURN = Outputs((0.5, -0.5), enabled=True)

HEARTBEAT = Heartbeat(type=6, autopilot=8, base_mode=0, custom_mode=0, system_status=4, mavlink_version=3)
MESSAGE = Received(HEARTBEAT, 255, 190, 0, Peer(0, "gcs"), introduced=True)


class Script:
    """A mind that says what the test tells it to, and remembers what it was told."""

    def __init__(self) -> None:
        self.outputs = OFF
        self.next: Outputs | None = None
        """Becomes `outputs` when a message comes."""
        self.calls: list[str] = []
        self.fault: BaseException | None = None
        self.idle = False
        self.reserved_ids: tuple[int, int] | None = None

    def receive(self, received: Received, now: float) -> None:
        self._happen("receive")
        self.outputs = self.next or self.outputs

    def tell_time(self, peer: Peer, now: float) -> None:
        self._happen("tell_time")

    def sense(self, readings: Readings, now: float) -> None:
        self._happen("sense")

    def tick(self, now: float) -> None:
        self._happen("tick")

    def observe(self, reports: Sequence[LinkReport], now: float) -> None:
        self._happen("observe")

    def messages_to_send(self) -> list[Outgoing]:
        self._happen("messages_to_send")
        return [Outgoing(HEARTBEAT)]

    def update_estop_input(self, reason: str | None, now: float) -> None:
        if reason is not None:
            self.calls.append(f"pressed: {reason}")
            self.outputs = OFF

    def motor_failed(self, reason: str, now: float) -> None:
        self.calls.append(f"failed: {reason}")
        self.outputs = OFF

    def motor_repaired(self, now: float) -> None:
        self.calls.append("repaired")

    def tick_outputs(self, now: float, *, powered: bool) -> bool:
        return self.idle and not powered

    def rest_period(self, now: float) -> float | None:
        return 0.1 if self.idle else None

    def shutdown(self, now: float) -> None:
        self.calls.append("shutdown")

    def _happen(self, call: str) -> None:
        self.calls.append(call)
        if self.fault is not None:
            raise self.fault


class Bench(SimulatedMotors):
    """Simulated motors that remember what was asked and break where the test wants."""

    def __init__(self) -> None:
        super().__init__(2)
        self.asked: list[str] = []
        self.broken: dict[str, Exception] = {}

    def enable(self) -> None:
        self._ask("enable")
        super().enable()

    def disable(self) -> None:
        self._ask("disable")
        super().disable()

    def set(self, throttles: Sequence[float]) -> None:
        self._ask("set", *throttles)
        super().set(throttles)

    def close(self) -> None:
        self._ask("close")
        super().disable()

    def _ask(self, verb: str, *values: float) -> None:
        self.asked.append(" ".join([verb, *map(str, values)]))
        if verb in self.broken:
            raise self.broken[verb]


def machine(prove: Callable[[], None] = lambda: None) -> tuple[ControlLoop, Script, Bench]:
    mind, motors = Script(), Bench()
    return ControlLoop(mind, motors, NoSensors(), prove=prove), mind, motors


def driving() -> tuple[ControlLoop, Script, Bench]:
    """A machine whose wheels turn: the danger that the tests below must see end."""
    body, mind, motors = machine()
    mind.outputs = AHEAD
    body.tick(0.0)
    assert motors.outputs == (0.5, 0.4)
    motors.asked.clear()
    mind.calls.clear()
    return body, mind, motors
