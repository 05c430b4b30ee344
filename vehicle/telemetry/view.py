"""What telemetry tells about, at one moment. Read only: builders in status.py and build_motion.py make messages of it."""

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
from vehicle.readings import Readings
from vehicle.safety.state_machine import Safety
from vehicle.telemetry.host import HostInfo


class TelemetryView(NamedTuple):
    """The rover at the time `now`; made in each cycle and for each demand."""

    now: float
    since_boot: float
    params: Params
    readings: Readings
    safety: Safety
    control: Control
    drive: Drive
    navigator: Navigator
    host: HostInfo
    rack: AccessorySet
    """Relays and servos."""
    logs: bool | None = None
    """Are they recorded as they should? None where none are wanted."""

    @property
    def estimate(self) -> Estimate:
        """Where it is and how it moves."""
        return self.navigator.estimate

    @property
    def home(self) -> Home | None:
        """Where RTL goes."""
        return self.navigator.home

    @property
    def boot_ms(self) -> int:
        """`time_boot_ms`."""
        return boot_ms(self.since_boot)

    @property
    def boot_us(self) -> int:
        """`time_usec` since boot."""
        return int(self.since_boot * 1e6)
