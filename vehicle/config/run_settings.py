"""Settings of one run of the vehicle, from the command line and the configuration file, for the daemon."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec

from link.transport.faults.settings import FaultSettings
from vehicle.accessories.settings import Accessories
from vehicle.camera.settings import CameraSettings
from vehicle.config.signing import SigningSettings
from vehicle.sensors.suite import SensorSettings
from vehicle.sim.body import SimulatedHome

SIMULATION_PARAMS = {"FS_LOOP_TIMEOUT": 1.0}
"""A desktop computer is not a real-time system: a pause of 0.2 s, critical for a real vehicle, is tolerated there."""


class Simulation(msgspec.Struct, frozen=True):
    """Settings of the simulated rover."""

    home: SimulatedHome = msgspec.field(default_factory=SimulatedHome)
    battery: float = 1.0
    """Charge at the start, 0 to 1."""
    seed: int = 1
    """Seed of the sensor noise."""
    truth: str | None = None
    """File to which the true position is appended."""
    walls: str | None = None
    """GeoJSON file of walls; None: there are none, and no range sensor."""
    faults: FaultSettings | None = None
    """Faults of its links; None: they work."""


class RunSettings(msgspec.Struct, frozen=True):
    """The settings of one run."""

    endpoints: tuple[str, ...]
    motors: Mapping[str, Any] = msgspec.field(default_factory=lambda: {"driver": "simulated"})
    """The driver's name as `driver`, and its settings; ignored in a simulation."""
    accessories: Accessories = msgspec.field(default_factory=Accessories)
    """Relays and servos; a simulation has simulated ones with the same numbers."""
    config: Path | None = None
    """The configuration file; safe-stop is called with the same one."""
    sensors: SensorSettings | None = None
    """None for a rover without sensors; ignored in a simulation."""
    simulation: Simulation | None = None
    camera: CameraSettings = CameraSettings()
    pinned: Mapping[str, float] = msgspec.field(default_factory=dict)
    """Parameters set in the configuration file, which ground stations cannot change."""
    params: Mapping[str, float] = msgspec.field(default_factory=dict)
    """Parameters of this run only."""
    motor_log: str | None = None
    state: Path | None = None
    """State folder for parameters and plans; None: nothing is saved."""
    logs: Path | None = None
    """Folder of telemetry logs; None: nothing is recorded."""
    signing: SigningSettings = msgspec.field(default_factory=SigningSettings)
    announce: bool = False
    """Announce the endpoints that listen by multicast DNS."""


class SettingsError(Exception):
    """The settings cannot be used; the text is one line."""
