"""The oldest versions that pyproject.toml allows, and the tests that use each package."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

EXTRAS = ("all", "pi")
"""What a user may install."""
TESTS: Mapping[str, tuple[str, ...]] = {
    "pymavlink": ("tests/dialects/test_axes.py",),
    "fastcrc": ("tests/link/protocol/test_framer.py", "tests/link/protocol/test_checksum.py"),
    "pyserial": ("tests/link/transport/test_serial_faults.py",),
    "textual": ("tests/groundstation/ui/links/test_screen.py",),
    "platformdirs": ("tests/groundstation/recent",),
    "msgspec": ("tests/groundstation/test_ipc.py", "tests/vehicle/config/test_config.py"),
    "zeroconf": ("tests/link/discovery",),
    "segno": ("tests/link/signing/test_key_qr.py",),
    "mnemonic": ("tests/link/signing/test_key_words.py",),
    "pysdl2": ("tests/groundstation/gamepad",),
    "pysdl2-dll": ("tests/groundstation/gamepad",),
    "textual-serve": ("tests/groundstation/web/test_server.py",),
    "aiohttp": ("tests/groundstation/web/test_server.py",),
    "gpiozero": ("tests/vehicle/motors/test_gpio.py", "tests/vehicle/motors/test_safety_pins.py"),
    "lgpio": ("tests/vehicle/motors/test_gpio.py",),
    "smbus2": ("tests/vehicle/hardware",),
    "mcap": ("tests/groundstation/export/test_mcap.py",),
    "rosbags": ("tests/groundstation/export/test_mcap.py",),
    "eclipse-zenoh": ("tests/link/fleet/test_transport.py",),
    "mcp": ("tests/groundstation/verbs/agents/test_server.py",),
    "xxhash": ("tests/groundstation/ros/rmw",),
}
"""Package -> the tests that import it. A new dependency needs a row."""


def lower_bounds(project: Mapping[str, Any]) -> dict[str, str]:
    """Return package -> oldest allowed version, of the table [project] of a pyproject.toml.

    Raises ValueError for a package without a lower bound.
    """
    oldest: dict[str, str] = {}
    for requirement in _requirements(project):
        versions = [each.version for each in requirement.specifier if each.operator in (">=", "==", "~=")]
        if len(versions) != 1:
            raise ValueError(f"{requirement} has {len(versions)} lower bounds")
        oldest[canonicalize_name(requirement.name)] = versions[0]
    return oldest


def _requirements(project: Mapping[str, Any]) -> Iterator[Requirement]:
    """Yield the dependencies and those of EXTRAS, with the extras that they are made of."""
    lines, later, seen = list(project["dependencies"]), list(EXTRAS), set[str]()
    while later:
        extra = later.pop()
        seen.add(extra)
        lines += project["optional-dependencies"][extra]
        for requirement in map(Requirement, project["optional-dependencies"][extra]):
            if requirement.name == project["name"]:
                later += requirement.extras - seen
    yield from (each for each in map(Requirement, lines) if each.name != project["name"])
