"""A helicopter, which no key drives, as ArduCopter was measured: STABILIZE makes thrust of the throttle."""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Autopilot, Command, ModeFlag, Result
from dialects.mode_tables import COPTER
from link.core import Received
from tests.fakes.vehicle import AnyCommand, FakeVehicle

HELICOPTER = 4
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

    def __init__(self, *, autopilot: int = Autopilot.ARDUPILOT, kind: int = HELICOPTER, lists: bool = True) -> None:
        super().__init__(autopilot=autopilot, driver=None, mode=0)
        self.kind = kind
        self.lists = lists
        self.altitude = self.climb = self.highest = 0.0
        self.hit_ground_at = 0.0
        """m/s of its hardest landing."""
        self.answers |= dict.fromkeys(
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
        self.armed, self.altitude, self.mode, self._throttle = True, altitude, 5, HOVER
        self._demand_at = float("inf")
        self.beat()

    def _flags(self) -> int:
        return ModeFlag.CUSTOM | (ModeFlag.ARMED if self.armed else 0)

    def _obey(self, message: AnyCommand, source: int) -> bool:
        if message.command == Command.DO_SET_MODE:
            self.mode = int(message.param2)
        elif message.command == Command.COMPONENT_ARM_DISARM:
            self.armed = message.param1 == 1
            self._throttle = self._throttle if self.armed else 0
        elif message.command == Command.REQUEST_MESSAGE and message.param1 == m.AvailableModes.id:
            self._list_modes()
        return message.command in (Command.DO_SET_MODE, Command.COMPONENT_ARM_DISARM)

    def _command(self, message: AnyCommand, received: Received) -> None:
        if message.command == Command.COMPONENT_ARM_DISARM:
            in_air = not message.param1 and message.param2 != FORCED and self.altitude > 0.0
            self.answers[message.command] = Result.FAILED if in_air else Result.ACCEPTED
        if message.command == Command.REQUEST_MESSAGE:
            has = self.lists and message.param1 == m.AvailableModes.id
            self.answers[message.command] = Result.ACCEPTED if has else Result.UNSUPPORTED
        super()._command(message, received)

    def _list_modes(self) -> None:
        for index, number in enumerate(LISTED, 1):
            name = COPTER[number].replace("_", "")[:4].encode()
            self.send(m.AvailableModes(len(LISTED), index, 0, number, 0, name))
