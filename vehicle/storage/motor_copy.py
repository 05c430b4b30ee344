"""A copy of the settings of motors and accessories for as long as a vehicle drives them, for safe-stop: their file may
change meanwhile.

There is one for each file of settings, in the usual state folder, because a broken file cannot say where another one
is. A vehicle that ends as it should has stopped its motors and takes the copy away; one that is killed leaves it.
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
    """Where the vehicle keeps things unless it is told otherwise: the service's folder, or one in your home."""
    if "STATE_DIRECTORY" in os.environ:  # from systemd's StateDirectory=, also for ExecStopPost=
        return Path(os.environ["STATE_DIRECTORY"].partition(":")[0])
    from platformdirs import user_state_path

    return user_state_path("mavhelm")


@contextlib.contextmanager
def settings_copy(parts: Mapping[str, Any], config: Path | None) -> Iterator[None]:
    """Keep a copy of `parts`, the tables of the file `config` by name, [motors] for one, until the end; beyond it where
    it ends by an exception.

    A copy that cannot be written is a warning and no more: safe-stop then goes by the file.
    """
    if config is None:
        yield
        return
    path = _path(config)
    writer = FileWriter(path.parent)
    writer.write(path.name, lambda: json.dumps(dict(parts), default=str).encode())
    writer.close()  # no wheel turns yet: there is time to wait for the disk
    if writer.problem:
        log.warning("after a kill safe-stop will have to go by %s alone: %s: %s", config, path, writer.problem)
    yield
    with contextlib.suppress(OSError):
        path.unlink()


def load_settings_copy(config: Path) -> dict[str, Any] | None:
    """The tables of what a killed vehicle drove by this file; None where none was killed, or nobody can tell."""
    try:
        parts = json.loads(_path(config).read_bytes())
    except (OSError, ValueError):
        return None
    motors = parts.get("motors") if isinstance(parts, dict) else None
    return parts if isinstance(motors, dict) and isinstance(motors.get("driver"), str) else None


def _path(config: Path) -> Path:
    name = sha256(os.fsencode(os.path.abspath(config))).hexdigest()[:12]
    return default_state_folder() / f"motors-{name}.json"
