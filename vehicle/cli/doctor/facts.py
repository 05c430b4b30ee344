"""DoctorFacts: what the rows of `mavhelm vehicle doctor` judge."""

from __future__ import annotations

from collections.abc import Mapping

import msgspec

from vehicle.cli.check import CheckResult
from vehicle.config.signing import SigningSettings
from vehicle.readings import ComputerReadings


class Device(msgspec.Struct, frozen=True):
    """One device file that the configuration needs."""

    path: str
    present: bool = True
    group: str = ""
    """Group of the file; "" if it is missing."""
    allowed: bool = True
    """This user may read and write it."""
    holder: str = ""
    """Program that has it open, where the kernel tells; e.g. "agetty (pid 412)"."""
    console: bool = False
    """The kernel writes its messages there."""


class Clock(msgspec.Struct, frozen=True):
    """The wall clock."""

    year: int
    synchronized: bool | None
    """By a time server, GPS or a clock chip; None if the kernel does not tell."""


class Space(msgspec.Struct, frozen=True):
    """Free space of the file system of a folder."""

    folder: str
    free: int
    """Bytes that this user may use."""


class VehicleDoctorFacts(msgspec.Struct, frozen=True, kw_only=True):
    """All facts. Those of the configuration are empty if the file has errors."""

    path: str
    """The configuration file."""
    user: str
    checks: tuple[CheckResult, ...] = ()
    """As `mavhelm vehicle check` prints them."""
    pins: tuple[str, ...] = ()
    """Pins in use, e.g. "GPIO 5"."""
    simulated_pins: bool = False
    """Simulated pins (gpiozero) replace those of the computer."""
    gpio: tuple[Device, ...] = ()
    """The pin controllers of this computer."""
    buses: tuple[Device, ...] = ()
    """I2C buses in use."""
    serial: tuple[Device, ...] = ()
    """Serial ports in use."""
    signing: SigningSettings = msgspec.field(default_factory=SigningSettings)
    open_links: tuple[str, ...] = ()
    """Endpoints that a whole network reaches."""
    trusted_links: Mapping[str, str] = msgspec.field(default_factory=dict)
    """Endpoints that need no key -> why."""
    missing_interfaces: tuple[str, ...] = ()
    """Those of signing.private that this computer does not have now."""
    keys: tuple[str, ...] = ()
    """Keys for signing: name, role, fingerprint."""
    key_problem: str = ""
    """Why the key file cannot be used."""
    params: Mapping[str, float] = msgspec.field(default_factory=dict)
    health: ComputerReadings
    clock: Clock
    spaces: tuple[Space, ...] = ()
    service: Mapping[str, str] | None = None
    """Properties of the unit as systemd names them; None without systemd."""

    @property
    def readable(self) -> bool:
        """Whether the file could be read, so that its hardware is known."""
        return any(each.item == "settings" and each.ok for each in self.checks)

    @property
    def running(self) -> bool:
        """Whether a vehicle runs on this computer, which then has motors and ports open."""
        active = self.service is not None and self.service.get("ActiveState") in ("active", "reloading")
        return active or any(each.item == "motors" and each.busy for each in self.checks)

    def select(self, *starts: str) -> list[CheckResult]:
        """Return the checks whose item starts with one of these texts."""
        return [each for each in self.checks if each.item.startswith(starts)]
