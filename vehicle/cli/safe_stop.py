"""`mavhelm vehicle safe-stop`: stop the motors of a killed vehicle. Reads [motors] and [accessories] only."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from link.runtime import journald
from link.toml.file import TomlError, read_toml


def stop_all(config: str) -> None:
    """Stop the motors that a killed vehicle used, and those in the file `config` if they differ.

    Raises TomlError if neither is known: nothing is stopped then.
    """
    from vehicle.storage.motor_copy import load_settings_copy

    used = load_settings_copy(Path(config))
    try:
        configured: Mapping[str, Any] = {**read_toml(config), "motors": read_motor_table(config)}
    except TomlError as error:
        if used is None:
            remedy = "nothing is stopped: cut the power of motors that turn, and fix the file"
            raise TomlError(f"{error}; {remedy}") from error
        configured = used
        _log(journald.ERROR, f"{error}; stopping only the motors that the vehicle used")
    settings = [configured] if used is None else [used, configured]
    for motors in _distinct([tables["motors"] for tables in settings]):
        _stop(motors)
    for accessories in _distinct([tables.get("accessories") or {} for tables in settings]):
        _make_safe(accessories)


def read_motor_table(path: str) -> dict[str, Any]:
    """Return [motors] of a file, unchecked. Raises TomlError."""
    table = read_toml(path).get("motors")
    if not isinstance(table, dict) or "driver" not in table:
        raise TomlError(f"{path}: no driver in [motors]; see `mavhelm vehicle check {path}`")
    return table


def _distinct(tables: Sequence[Any]) -> list[Any]:
    return [table for index, table in enumerate(tables) if table not in tables[:index]]


def _make_safe(accessories: Any) -> None:
    """Make the accessories safe, after the motors, which are more urgent."""
    from vehicle.accessories.safe_stop import safe_stop

    for safe, text in safe_stop(accessories):
        _log(journald.INFO if safe else journald.ERROR, text)


def _stop(motors: Mapping[str, Any]) -> None:
    from vehicle.motors.drivers import safe_stop

    driver = str(motors["driver"])
    problems = safe_stop(driver, {key: value for key, value in motors.items() if key != "driver"})
    for problem in problems:
        _log(journald.ERROR, problem)
    if problems:
        _log(journald.CRITICAL, f"{driver}: motors may still turn, cut their power")
    else:
        _log(journald.INFO, f"{driver}: motors neutral and without power")


def _log(severity: int, text: str) -> None:
    sys.stderr.write(f"{journald.priority_prefix(severity)}mavhelm vehicle safe-stop: {text}\n")
