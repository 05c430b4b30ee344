"""What one run of the vehicle is to be: said by the command line and the file, read by the daemon."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from vehicle.accessories.settings import Accessories
from vehicle.sensors.suite import SensorSettings
from vehicle.sim.body import SimulatedHome


@dataclass(frozen=True, slots=True)
class Simulation:
    """Wishes for the simulated rover."""

    home: SimulatedHome = field(default_factory=SimulatedHome)
    battery: float = 1.0
    """Charge at the start, 0..1."""
    seed: int = 1
    """Of the sensors' noise."""
    truth: str | None = None
    """File to append to where it really is."""


@dataclass(frozen=True, slots=True)
class RunSettings:
    """What the command line or a file asks for."""

    endpoints: tuple[str, ...]
    motors: Mapping[str, Any] = field(default_factory=lambda: {"driver": "simulated"})
    """The driver's name as `driver`, and its settings; a simulation has its own."""
    accessories: Accessories = field(default_factory=Accessories)
    """Relays and servos; a simulation has simulated ones of the same numbers."""
    config: Path | None = None
    """The file that says so; safe-stop is told the same one."""
    sensors: SensorSettings | None = None
    """None: a rover that measures nothing. A simulation has its own."""
    simulation: Simulation | None = None
    pinned: Mapping[str, float] = field(default_factory=dict)
    """Parameters that the file of settings sets, and no ground station changes."""
    params: Mapping[str, float] = field(default_factory=dict)
    """Parameters of this run."""
    motor_log: str | None = None
    state: Path | None = None
    """Folder that keeps what ground stations set; None: nothing is kept."""
    logs: Path | None = None
    """Folder of telemetry logs; None: nothing is recorded."""


class SettingsError(Exception):
    """What was asked for cannot be had; the text is one line."""
