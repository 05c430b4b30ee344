"""The parameters that a vehicle with this file would run with, for the programs beside it: check and motor-test."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from vehicle.config.config import Config
from vehicle.motors.drivers import profile_params
from vehicle.params import Params, merge_params
from vehicle.storage.file_writer import FileWriter
from vehicle.storage.motor_copy import default_state_folder
from vehicle.storage.param_store import ParamStore

SERVICE = Path("/var/lib/mavhelm")
"""Where the service keeps things: StateDirectory in vehicle/cli/systemd_unit.py."""


@dataclass(frozen=True, slots=True)
class EffectiveParams:
    """What is in force, and where it is from."""

    params: Params
    folder: Path
    """Where the vehicle keeps what ground stations set."""
    saved_count: int
    """How many of the kept ones count."""
    left_out: tuple[str, ...]
    """Kept ones that do not fit any more, a line each."""
    damage: str | None
    """Why the kept ones could not be read, and what to do."""


def load_effective_params(config: Config, folder: str | None = None) -> EffectiveParams:
    """As vehicle/runtime/factory.py does it: defaults, a known car's, kept ones, the file's. `folder` wins over the file's."""
    where = state_folder_of(folder or config.state)
    store = ParamStore(FileWriter(where))
    usual = profile_params(config.motors.get("driver", ""))
    params, left_out = merge_params(config.params, kept=store.values, usual=usual)
    count = len(store.values.keys() - config.params.keys()) - len(left_out)
    damage = store.damage and f"{store.damage}; start the vehicle and set one from a ground station, which ends this"
    return EffectiveParams(params, where, count, tuple(left_out), damage)


def state_folder_of(configured: str | None) -> Path:
    """The folder of the vehicle: of the service where there is one, which this program is not."""
    if configured:
        return Path(configured)
    beside_service = "STATE_DIRECTORY" not in os.environ and os.path.lexists(SERVICE)
    return SERVICE if beside_service else default_state_folder()
