"""`vehicle safe-stop`: stop what a killed vehicle left turning. It reads [motors] and [accessories], and no more."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from link.runtime import journald
from link.runtime.toml_file import TomlError, read_toml


def stop_all(config: str) -> None:
    """Stop what a killed vehicle drove, and what the file `config` names now, where that is something else.

    Raises TomlError where neither is known: nothing is stopped then.
    """
    from vehicle.storage.motor_copy import load_settings_copy

    driven = load_settings_copy(Path(config))
    try:
        named: Mapping[str, Any] = {**read_toml(config), "motors": read_motor_table(config)}
    except TomlError as error:
        if driven is None:
            raise TomlError(f"{error}; nothing is stopped: cut the power of motors that turn, and mend it") from error
        named = driven
        _log(journald.ERROR, f"{error}; so only what the vehicle drove is stopped")
    both = [named] if driven is None else [driven, named]
    for motors in _different([parts["motors"] for parts in both]):
        _stop(motors)
    for accessories in _different([parts.get("accessories") or {} for parts in both]):
        _make_safe(accessories)


def read_motor_table(path: str) -> dict[str, Any]:
    """[motors] of a file, as it stands there. Raises TomlError."""
    table = read_toml(path).get("motors")
    if not isinstance(table, dict) or "driver" not in table:
        raise TomlError(f"{path}: no driver in [motors]; `vehicle check {path}` says more")
    return table


def _different(tables: Sequence[Any]) -> list[Any]:
    return [table for index, table in enumerate(tables) if table not in tables[:index]]


def _make_safe(accessories: Any) -> None:
    """After the motors, which are more urgent."""
    from vehicle.accessories.safe_stop import safe_stop

    for well, words in safe_stop(accessories):
        _log(journald.INFO if well else journald.ERROR, words)


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
    sys.stderr.write(f"{journald.priority_prefix(severity)}vehicle safe-stop: {text}\n")
