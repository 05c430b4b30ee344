"""A copter as ArduCopter was measured: STABILIZE turns the throttle of MANUAL_CONTROL into thrust."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Autopilot, Command, ModeFlag, Result, SystemState
from dialects.mode_tables import COPTER
from link.core import Received
from tests.groundstation.fake_vehicle import FakeVehicle

QUADROTOR = 2
HOVER = 500
"""z of MANUAL_CONTROL that carries it."""
CLIMB = 5.4 / 3.0 / 100
"""m/s for each step of z above HOVER: holding 600 for 3 s lifted it to 5.4 m."""
GRAVITY = 9.81
LATCH = 3.0
"""RC_OVERRIDE_TIME, s."""
FORCED = 21196
LISTED = (0, 2, 3, 4, 5, 6, 9, 16)
"""custom_mode of what it lists by AVAILABLE_MODES, with names of four letters."""


class FakeCopter(FakeVehicle):
    """Altitude is ground truth. In the air it refuses to disarm unless that is forced, and then it falls."""

    def __init__(self, *, autopilot: int = Autopilot.ARDUPILOT, kind: int = QUADROTOR, lists: bool = True) -> None:
        super().__init__(autopilot=autopilot, driver=None)
        self.kind = kind
        self.custom_mode = 0
        self.lists = lists
        self.altitude = self.climb = self.highest = 0.0
        self.hit_ground_at = 0.0
        """m/s of its hardest landing."""
        self.answers = dict.fromkeys(
            (Command.REQUEST_OPERATOR_CONTROL, Command.DO_SET_SAFETY_SWITCH_STATE), Result.UNSUPPORTED
        )
        self._throttle = 0
        self._demand_at = self._moved_at = 0.0

    def receive(self, received: Received, now: float) -> None:
        """Take the throttle; the rest as FakeVehicle."""
        message = received.message
        if isinstance(message, m.ManualControl) and message.target == self.system:
            self._throttle, self._demand_at = message.z, now
        super().receive(received, now)

    def tick(self, now: float) -> None:
        """Climb or fall."""
        super().tick(now)
        seconds, self._moved_at = now - self._moved_at, now
        if now - self._demand_at > LATCH:
            self._throttle = 0
        if self.armed and self._throttle >= HOVER:
            self.climb = (self._throttle - HOVER) * CLIMB
        elif self.altitude > 0.0:
            self.climb -= GRAVITY * seconds
        self.altitude = max(0.0, self.altitude + self.climb * min(seconds, 1.0))
        self.highest = max(self.highest, self.altitude)
        if self.altitude == 0.0 and self.climb < 0.0:
            self.hit_ground_at, self.climb = max(self.hit_ground_at, -self.climb), 0.0

    def lift(self, altitude: float) -> None:
        """Let its own pilot fly it: armed, in LOITER, at this altitude."""
        self.armed, self.altitude, self.custom_mode, self._throttle = True, altitude, 5, HOVER
        self._demand_at = float("inf")
        self.beat()

    def beat(self) -> None:
        """HEARTBEAT of a copter."""
        flags = ModeFlag.CUSTOM | (ModeFlag.ARMED if self.armed else 0)
        status = SystemState.ACTIVE if self.armed else SystemState.STANDBY
        self.send(m.Heartbeat(self.kind, self.autopilot, flags, self.custom_mode, status, 3))

    def _obey(self, message: m.CommandLong, source: int) -> None:
        if message.command == Command.DO_SET_MODE:
            self.custom_mode = int(message.param2)
        elif message.command == Command.COMPONENT_ARM_DISARM:
            self.armed = message.param1 == 1
            self._throttle = self._throttle if self.armed else 0
        elif message.command == Command.REQUEST_MESSAGE and message.param1 == m.AvailableModes.id:
            self._list_modes()

    def _command(self, message: m.CommandLong, source: int) -> None:
        if message.command == Command.COMPONENT_ARM_DISARM:
            in_air = not message.param1 and message.param2 != FORCED and self.altitude > 0.0
            self.answers[message.command] = Result.FAILED if in_air else Result.ACCEPTED
        if message.command == Command.REQUEST_MESSAGE:
            has = self.lists and message.param1 == m.AvailableModes.id
            self.answers[message.command] = Result.ACCEPTED if has else Result.UNSUPPORTED
        super()._command(message, source)

    def _list_modes(self) -> None:
        for index, number in enumerate(LISTED, 1):
            name = COPTER[number].replace("_", "")[:4].encode()
            self.send(m.AvailableModes(len(LISTED), index, 0, number, 0, name))
