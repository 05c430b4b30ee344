"""A copy of the motor and accessory settings of a running vehicle, for safe-stop: the file may change meanwhile.

There is one copy for each configuration file, in the default state folder, because a broken file cannot name another
one. A vehicle that ends normally has stopped its motors and removes the copy; a killed vehicle leaves it behind.
"""

from __future__ import annotations

import contextlib
import json
import logging
import os
from collections.abc import Iterator, Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

from vehicle.storage.file_writer import FileWriter

log = logging.getLogger(__name__)


def default_state_folder() -> Path:
    """Return the default state folder: the service's, or one in the user's home."""
    if "STATE_DIRECTORY" in os.environ:  # from systemd's StateDirectory=, also set for ExecStopPost=
        return Path(os.environ["STATE_DIRECTORY"].partition(":")[0])
    from platformdirs import user_state_path

    return user_state_path("mavhelm")


@contextlib.contextmanager
def settings_copy(tables: Mapping[str, Any], config: Path | None) -> Iterator[None]:
    """Keep a copy of `tables` of the file `config`, by name, such as [motors], until the context ends.

    The copy stays if the context ends with an exception. If it cannot be written, a warning is logged, and safe-stop
    uses the file alone.
    """
    if config is None:
        yield
        return
    path = _path(config)
    writer = FileWriter(path.parent)
    writer.write(path.name, lambda: json.dumps(dict(tables), default=str).encode())
    writer.close()  # waits for the disk: no motor turns yet
    if writer.problem:
        log.warning("after a kill, safe-stop can use %s only: %s: %s", config, path, writer.problem)
    yield
    with contextlib.suppress(OSError):
        path.unlink()


def load_settings_copy(config: Path) -> dict[str, Any] | None:
    """Return the tables that a killed vehicle ran with, None if no usable copy exists."""
    try:
        tables = json.loads(_path(config).read_bytes())
    except (OSError, ValueError):
        return None
    motors = tables.get("motors") if isinstance(tables, dict) else None
    return tables if isinstance(motors, dict) and isinstance(motors.get("driver"), str) else None


def _path(config: Path) -> Path:
    name = sha256(os.fsencode(os.path.abspath(config))).hexdigest()[:12]
    return default_state_folder() / f"motors-{name}.json"
