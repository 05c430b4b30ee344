"""Keys for a soak in which both ends sign, and ignore what is not signed."""

from __future__ import annotations

from pathlib import Path

from link.signing.key_actions import make_key
from link.signing.key_file import FILE, load_keys, save_keys, station_key_file
from link.signing.role import SigningRole


def make_keys(folder: Path) -> tuple[str, ...]:
    """Give the stations of this user and a vehicle in `folder` one key; return the options of the vehicle.

    It is one key for both stations, because they share a bridge (docs/security.md, S10). The state of the vehicle, with
    the timestamps that it has accepted, outlives a kill.
    """
    make_key(station_key_file(), "laptop", SigningRole.SET_UP)
    save_keys(folder / FILE, load_keys(station_key_file()))
    config = folder / "rover.toml"
    config.write_text("[signing]\nrequired = true\n")
    return "--config", str(config), "--state", str(folder)
