"""A vehicle that behaves as ArduRover 4.7 did in measurements: it drives, and holds the last demand for 3 s."""

from __future__ import annotations

from collections.abc import Callable

from dialects import messages as m
from dialects.enums import Autopilot, Command, DataStream, Result
from dialects.messages import INVALID_AXIS, boot_ms
from dialects.modes import Mode
from groundstation.vehicles.probes.stream_requests import STREAM_RATES
from link.core import Received
from tests.fakes.vehicle import PX4_MANUAL, FakeVehicle

LATCH = 3.0
"""RC_OVERRIDE_TIME, s."""
LONG_LATCH = 30.0
"""The same for tests of stops, so that one on a machine that is late by seconds is still not the rover's own doing."""

PULSES = {"MIN": 1000.0, "TRIM": 1500.0, "MAX": 2000.0, "REVERSED": 0.0}
"""SERVOn_ and RCn_ of its simulation, us."""

RC_MAP = {"RCMAP_ROLL": 1.0, "RCMAP_THROTTLE": 3.0}

NOT_KNOWN = (Command.REQUEST_OPERATOR_CONTROL, Command.DO_SET_SAFETY_SWITCH_STATE)


class FakeArduPilot(FakeVehicle):
    """Axes y and z, one ground station by its system id, no arming with throttle, telemetry on request."""

    def __init__(
        self,
        *,
        station: int = 255,
        mode: int | None = None,
        autopilot: int = Autopilot.ARDUPILOT,
        latch: float = LATCH,
    ) -> None:
        super().__init__(autopilot=autopilot, mode=mode)
        self.answers |= dict.fromkeys(NOT_KNOWN, Result.UNSUPPORTED)
        self.params |= {"RC_OVERRIDE_TIME": latch, "FS_GCS_ENABLE": 0.0, "FS_THR_ENABLE": 1.0}
        self.streams = [number for number, wanted in STREAM_RATES.items() if wanted.only in (None, autopilot)]
        """Messages that it has."""
        self.rates = dict.fromkeys(self.streams, 1.0)
        """Hz, of each message that it sends."""
        self.turning: list[tuple[float, int, int]] = []
        """Time, steering and throttle whenever one of them changed."""
        self.sticks: dict[int, int] = {}
        """RC channel -> pulse of the transmitter, us, in place of the demand."""
        self._station, self._latch = station, latch
        self._steering = self._throttle = 0
        self._demand_at = 0.0
        self._due = dict.fromkeys(self.streams, 0.0)

    @property
    def moves(self) -> bool:
        """The motors turn."""
        return bool(self.turning and any(self.turning[-1][1:]))

    @property
    def stopped_at(self) -> float:
        """When they stopped."""
        assert not self.moves
        return self.turning[-1][0]

    def receive(self, received: Received, now: float) -> None:
        """Handle demands of its ground station, group requests, and what FakeVehicle handles."""
        message = received.message
        if isinstance(message, m.ManualControl) and received.system == self._station and message.target == 1:
            self._steering, self._throttle = (0 if axis == INVALID_AXIS else axis for axis in (message.y, message.z))
            self._demand_at = now
        elif isinstance(message, m.RequestDataStream):
            group = DataStream(message.req_stream_id)
            for number in (number for number in self.streams if STREAM_RATES[number].group is group):
                self.rates[number] = float(message.req_message_rate)
        self._allow_arming()
        super().receive(received, now)
        self._drive(now)

    def tick(self, now: float) -> None:
        """Drop an old demand, send telemetry."""
        super().tick(now)
        if now - self._demand_at > self._latch:
            self._steering = self._throttle = 0
        self._drive(now)
        for number, due in self._due.items():
            if self.rates[number] and now >= due:
                self._due[number] = max(due, now - 0.1) + 1 / self.rates[number]
                self.send(_TELEMETRY[number](self, now))

    def reboot(self) -> None:
        """Forget all requests."""
        self.armed = False
        self.rates = dict.fromkeys(self.streams, 1.0)

    def set_pulses(self, *channels: str) -> None:
        """Give channels, such as "SERVO1", their limits, and the sticks their channels."""
        self.params |= RC_MAP
        for channel in channels:
            self.params |= {f"{channel}_{name}": value for name, value in PULSES.items()}

    def servo(self, value: int) -> int:
        """The pulse for -1000..1000, us."""
        return 1500 + value // 2

    def _allow_arming(self) -> None:
        if self._throttle:
            refused = Result.FAILED, "Arm: Throttle (RC3) is not neutral"
            self.answers[Command.COMPONENT_ARM_DISARM] = lambda command: refused if command.param1 else None
        else:
            self.answers.pop(Command.COMPONENT_ARM_DISARM, None)

    def _obey(self, message: m.CommandLong | m.CommandInt, source: int) -> bool:
        if message.command != Command.SET_MESSAGE_INTERVAL:
            return super()._obey(message, source)
        self.rates[int(message.param1)] = 1e6 / message.param2
        return False

    def _drive(self, now: float) -> None:
        drives = self.armed and self.mode == (PX4_MANUAL if self.autopilot == Autopilot.PX4 else Mode.MANUAL)
        outputs = (self._steering, self._throttle) if drives else (0, 0)
        if not self.turning or self.turning[-1][1:] != outputs:
            self.turning.append((now, *outputs))


def _servos(vehicle: FakeArduPilot, now: float) -> m.Message:
    steering, throttle = vehicle.turning[-1][1:]
    return m.ServoOutputRaw(0, 0, vehicle.servo(steering), 0, vehicle.servo(throttle), 0, 0, 0, 0, 0)


def _channels(vehicle: FakeArduPilot, now: float) -> m.Message:
    steering, throttle = vehicle.turning[-1][1:]
    pulses = {f"chan{number}_raw": 0 for number in range(1, 19)}
    pulses |= {"chan1_raw": vehicle.servo(steering), "chan3_raw": vehicle.servo(throttle)}
    pulses |= {f"chan{channel}_raw": pulse for channel, pulse in vehicle.sticks.items()}
    return m.RcChannels(time_boot_ms=boot_ms(now), chancount=3, rssi=255, **pulses)


_TELEMETRY: dict[int, Callable[[FakeArduPilot, float], m.Message]] = {
    m.Attitude.id: lambda _, now: m.Attitude(boot_ms(now), 0.0, 0.0, 1.0, 0.0, 0.0, 0.0),
    m.LocalPositionNed.id: lambda _, now: m.LocalPositionNed(boot_ms(now), 1.0, 2.0, 0.0, 0.0, 0.0, 0.0),
    m.GlobalPositionInt.id: lambda _, now: m.GlobalPositionInt(boot_ms(now), 1, 1, 0, 0, 0, 0, 0, 0),
    m.ServoOutputRaw.id: _servos,
    m.VfrHud.id: lambda vehicle, _: m.VfrHud(0.0, 2.0 if vehicle.moves else 0.0, 0, 0, 0.0, 0.0),
    m.SysStatus.id: lambda *_: m.SysStatus(0, 0, 0, 0, 12000, 100, 80, 0, 0, 0, 0, 0, 0),
    m.GpsRawInt.id: lambda *_: m.GpsRawInt(0, 3, 0, 0, 0, 0, 0, 0, 0, 9),
    m.BatteryStatus.id: lambda *_: m.BatteryStatus(0, 0, 0, 0, [12000] + [65535] * 9, 100, 0, 0, 80),
    m.RcChannels.id: _channels,
    m.ActuatorOutputStatus.id: lambda *_: m.ActuatorOutputStatus(0, 2, [0.0, -0.5] + [0.0] * 30),
    m.EkfStatusReport.id: lambda *_: m.EkfStatusReport(0x033F, 0.1, 0.05, 0.1, 0.2, 0.0),
    m.EstimatorStatus.id: lambda *_: m.EstimatorStatus(0, 0x033F, 0.1, 0.1, 0.0, 0.1, 0.0, 0.0, 0.4, 0.4),
    m.FenceStatus.id: lambda *_: m.FenceStatus(0, 0, 0, 0, 0),
    m.Vibration.id: lambda *_: m.Vibration(0, 1.0, 2.0, 3.0, 0, 0, 0),
    m.MissionCurrent.id: lambda *_: m.MissionCurrent(0),
    m.NavControllerOutput.id: lambda *_: m.NavControllerOutput(0.0, 0.0, 0, 0, 12, 0.0, 0.0, 0.0),
}
