"""What the daemon and the process of the camera tell each other, as JSON in packets."""

from __future__ import annotations

import msgspec

from vehicle.camera.scene import Pose, ScenePoint
from vehicle.camera.settings import CameraSettings


class Setup(msgspec.Struct, frozen=True):
    """For the process, as an argument."""

    settings: CameraSettings
    walls: tuple[tuple[ScenePoint, ScenePoint], ...] = ()


class Orders(msgspec.Struct, frozen=True):
    """From the daemon, the newest counts."""

    targets: tuple[tuple[str, int], ...] = ()
    """Where pictures go; none: stop the camera."""
    pose: Pose = Pose()
    """Of the simulated rover."""
    waypoints: tuple[ScenePoint, ...] = ()
