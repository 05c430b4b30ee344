"""The file groundstation.toml: where it is, its settings, and one line for each mistake in it."""

from __future__ import annotations

import os
import re
from collections.abc import Container, Mapping
from pathlib import Path
from typing import Any

import msgspec
from platformdirs import user_config_path

from groundstation.config.checks import Problem, find_problems
from groundstation.input.keymap import KEYMAPS
from groundstation.input.keymap_file import flatten
from link.toml.file import TomlError, find_unsupported, parse_toml, read_text
from link.toml.lines import find_line

VARIABLE = "MAVHELM_CONFIG"
"""Environment variable with the path of another file."""

FILE = "groundstation.toml"

MAX_SIZE = 256 * 1024
"""Bytes of a file that is read: far more than all settings need."""

PATHS = ("keymap", "folder", "log_file", "dialect", "param_docs", "record_folder")
"""Settings with a path, which is relative to the folder of the file."""

_AT_LINE = re.compile(r" \(?at line (\d+)(, column \d+\))?")


class ConfigError(Exception):
    """The file cannot be used. Each of `problems` is one line: file, line, key, what is wrong and what is allowed."""

    def __init__(self, *problems: str) -> None:
        super().__init__(problems[0])
        self.problems = problems


class ConfigFile(msgspec.Struct, frozen=True):
    """A file without mistakes."""

    path: Path
    text: str
    values: Mapping[str, Any]
    """The settings in it: paths are from the working folder, and [keys] has the ids of actions."""

    def place(self, name: str) -> str:
        """Return where a setting is, "FILE:LINE"."""
        return f"{self.path}:{_line(self.text, (name,))}"


def default_path() -> Path:
    """Return the path in the user's config folder: $XDG_CONFIG_HOME/mavhelm on Linux."""
    return user_config_path("mavhelm") / FILE


def choose_path(option: str | None, environment: Mapping[str, str]) -> tuple[Path, bool]:
    """Return the path of the file, and whether the user has named it, by the option or by MAVHELM_CONFIG."""
    named = option or environment.get(VARIABLE)
    return (Path(os.path.expanduser(named)), True) if named else (default_path(), False)


def read_config(path: Path, reserved: Container[str] = ()) -> ConfigFile:
    """Read the file; no endpoint may have one of the names in `reserved`. Raises ConfigError."""
    try:
        text = read_text(path, MAX_SIZE)
        table = parse_toml(text, str(path))
    except TomlError as error:
        raise ConfigError(_with_line(path, str(error))) from error
    values = _translate(table, path.parent)
    unsupported: list[Problem] = [((re.split(r"[.\[:]", line)[0],), line) for line in find_unsupported(table)]
    if problems := unsupported or list(find_problems(values, reserved)):
        found = sorted((_line(text, key), what) for key, what in problems)
        raise ConfigError(*(f"{path}:{line}: {what}" for line, what in found))
    return ConfigFile(path, text, values)


def _with_line(path: Path, error: str) -> str:
    """Return the error of the TOML parser with the line where compilers write it."""
    found = _AT_LINE.search(error)
    if found is None:
        return error
    return f"{path}:{found[1]}{_AT_LINE.sub('', error, count=1).removeprefix(str(path))}"


def _translate(table: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    values = dict(table)
    for name in PATHS:
        value = values.get(name)
        if isinstance(value, str) and _is_path(name, value, folder):
            values[name] = str(folder / os.path.expanduser(value))
    if isinstance(values.get("keys"), dict):
        values["keys"] = flatten(values["keys"])
    return values


def _is_path(name: str, value: str, folder: Path) -> bool:
    """Return whether a text is a path: a key map may be a name, a dialect one of the files that pymavlink ships."""
    if name == "dialect":
        return "/" in value or os.path.exists(folder / value)
    return value not in KEYMAPS


def _line(text: str, key: tuple[str, ...]) -> int:
    """Return the line of a key. The id of an action may be written as a key or as a table in a table."""
    table, *rest = key
    places = (key, (table, *".".join(rest).split(".", 1)), (table,))
    return next((line for each in places if (line := find_line(text, each)) is not None), 1)
