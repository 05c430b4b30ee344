"""DISTANCE_SENSOR and OBSTACLE_DISTANCE of companions.

Only components of this vehicle count, whose sender has sent a HEARTBEAT and may drive. What they say can make the rover
slower and nothing else: each sensor counts for itself, and none makes another one say less.
"""

from __future__ import annotations

from dialects import messages as m
from dialects.enums import Severity
from link.core import Received
from link.signing.role import SigningRole
from vehicle.commands.access import Access
from vehicle.commands.context import COMPONENT, Context
from vehicle.commands.inbound import InboundMessage, InboundTable
from vehicle.proximity.cones import parse_distance_sensor, parse_obstacle_distance
from vehicle.proximity.mounting import mount_around
from vehicle.readings import Scan


class ProximityMessages:
    """Passes the scans of companions to Obstacles."""

    def __init__(self, context: Context) -> None:
        self._params = context.params
        self._control = context.control
        self._navigator = context.navigator
        self._texts = context.statustext
        self._obstacles = context.obstacles

    def messages(self) -> InboundTable:
        """Return the rows of the messages handled here."""
        return (
            InboundMessage(m.DistanceSensor, Access.INTRODUCED, "obstacle, see PRX1_TYPE",
                           self._handle_distance),
            InboundMessage(m.ObstacleDistance, Access.INTRODUCED,
                           "obstacles all around, as DISTANCE_SENSOR", self._handle_distances),
        )  # fmt: skip

    def _handle_distance(self, received: Received, message: m.DistanceSensor, now: float) -> None:
        if self._counts(received):
            self._hear(received, f"{message.id}", parse_distance_sensor(message), now)

    def _handle_distances(self, received: Received, message: m.ObstacleDistance, now: float) -> None:
        if self._counts(received):
            scan = parse_obstacle_distance(message, self._navigator.estimate.yaw)
            self._hear(received, "round", scan if isinstance(scan, str) else mount_around(scan, self._params), now)

    def _counts(self, received: Received) -> bool:
        is_component = received.system == self._control.system and received.component != COMPONENT
        return is_component and received.role >= SigningRole.DRIVE and self._obstacles.accepts_messages

    def _hear(self, received: Received, sensor: str, scan: Scan | str, now: float) -> None:
        refused = self._obstacles.refused
        name = f"{received.component}/{sensor}"
        self._obstacles.hear((received.peer, received.component, sensor), name, scan, now)
        if self._obstacles.refused > refused:
            self._texts.send_once("range sensors", Severity.WARNING, f"Range sensor {name} ignored: too many", now)
