"""What the handlers of messages and commands act on, in two frozen values."""

from __future__ import annotations

from collections.abc import Callable

import msgspec

from link.services.pacing import BulkPacer
from vehicle.autonomy.navigator import Navigator
from vehicle.camera.camera import Camera
from vehicle.commands.access import CommandAccess
from vehicle.drive.control import Control
from vehicle.drive.mixer import Mixer
from vehicle.params import Params
from vehicle.proximity.obstacles import Obstacles
from vehicle.safety.state_machine import Safety
from vehicle.statustext import StatusTextQueue
from vehicle.telemetry.link_status import LinkStatusReporter
from vehicle.telemetry.telemetry import Telemetry
from vehicle.telemetry.view import TelemetryView

COMPONENT = 1
"""MAV_COMP_ID_AUTOPILOT1: QGroundControl shows a vehicle only for this component id."""


class Context(msgspec.Struct, frozen=True):
    """The parts of the vehicle that handlers read and call."""

    params: Params
    safety: Safety
    control: Control
    navigator: Navigator
    statustext: StatusTextQueue
    access: CommandAccess
    obstacles: Obstacles
    mixer: Mixer
    """Motors and servo outputs of this kind of drive."""
    pacer: BulkPacer
    """Limits what parameter lists, plans and logs send."""
    file_pacer: BulkPacer
    """Limits what files send."""
    arming_note: str | None = None
    """What is said at each arming."""

    @property
    def ids(self) -> tuple[int, int]:
        """System id and component id of this vehicle."""
        return self.control.system, COMPONENT


class Reporting(msgspec.Struct, frozen=True):
    """What telemetry is built from and where it goes."""

    telemetry: Telemetry
    links: LinkStatusReporter
    build_view: Callable[[float], TelemetryView]
    """Returns the vehicle at a time."""
    camera: Camera | None = None
    """None: there is none."""
