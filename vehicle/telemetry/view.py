"""What telemetry is built from: the vehicle at one moment. The builders of this package turn it into messages."""

from __future__ import annotations

from typing import NamedTuple

from dialects.messages import boot_ms
from vehicle.accessories.accessory_set import AccessorySet
from vehicle.autonomy.navigator import Navigator
from vehicle.drive.control import Control
from vehicle.drive.drive import Drive
from vehicle.navigation.estimate import Estimate
from vehicle.navigation.geo import Home
from vehicle.params import Params
from vehicle.proximity.obstacles import Obstacles
from vehicle.readings import Readings
from vehicle.safety.state_machine import Safety
from vehicle.telemetry.host import HostInfo


class TelemetryView(NamedTuple):
    """The vehicle at the time `now`; built for each cycle and each demand, used at once and never kept.

    It refers to the parts of the vehicle instead of copying their values. A cycle builds two or three of 40 streams, so
    copying all values would cost more than building the messages. The builders only read.
    """

    now: float
    since_boot: float
    params: Params
    readings: Readings
    safety: Safety
    control: Control
    drive: Drive
    fresh_speed: float
    """m/s that the age of the commands allows; infinite while nothing is limited."""
    navigator: Navigator
    obstacles: Obstacles
    host: HostInfo
    rack: AccessorySet
    """Relays and servos."""
    logs: bool | None = None
    """Logs are written. None if logging is off."""

    @property
    def estimate(self) -> Estimate:
        """Position, heading and speed."""
        return self.navigator.estimate

    @property
    def home(self) -> Home | None:
        """Home position, None until it is known."""
        return self.navigator.home

    @property
    def boot_ms(self) -> int:
        """`time_boot_ms`."""
        return boot_ms(self.since_boot)

    @property
    def boot_us(self) -> int:
        """`time_usec` since boot."""
        return int(self.since_boot * 1e6)
