"""The parameters that a vehicle would use with a configuration file, for its `check` and `motor-test`."""

from __future__ import annotations

import os
from pathlib import Path

import msgspec

from vehicle.config.config import Config
from vehicle.config.merge import merge_params
from vehicle.motors.drivers import profile_params
from vehicle.params import Params
from vehicle.storage.file_writer import FileWriter
from vehicle.storage.motor_copy import default_state_folder
from vehicle.storage.param_store import ParamStore

SERVICE = Path("/var/lib/mavhelm")
"""State folder of the service: StateDirectory in vehicle/cli/systemd_unit.py."""


class EffectiveParams(msgspec.Struct, frozen=True):
    """The parameters, and where they come from."""

    params: Params
    folder: Path
    """State folder of the vehicle."""
    saved_count: int
    """Number of saved parameters in use."""
    left_out: tuple[str, ...]
    """Saved parameters that are not valid any more, a line each."""
    damage: str | None
    """Why the saved parameters could not be read, and what to do."""


def load_effective_params(config: Config, folder: str | None = None) -> EffectiveParams:
    """Merge parameters as vehicle/runtime/factory.py does: defaults, a known car's, saved ones, those of the file.

    `folder` replaces the state folder of the file.
    """
    state = state_folder_of(folder or config.state)
    store = ParamStore(FileWriter(state))
    usual = profile_params(config.motors.get("driver", ""))
    params, left_out = merge_params(config.params, kept=store.values, usual=usual)
    count = len(store.values.keys() - config.params.keys()) - len(left_out)
    remedy = "start the vehicle and set a parameter from a ground station to repair it"
    damage = store.damage and f"{store.damage}; {remedy}"
    return EffectiveParams(params, state, count, tuple(left_out), damage)


def state_folder_of(configured: str | None) -> Path:
    """Return the state folder of the vehicle: that of the service if it exists, as this program is not the service."""
    if configured:
        return Path(configured)
    beside_service = "STATE_DIRECTORY" not in os.environ and os.path.lexists(SERVICE)
    return SERVICE if beside_service else default_state_folder()
