"""The settings in force: the command line wins over the environment, that over the file, that over the defaults."""

from __future__ import annotations

from collections.abc import Collection, Container, Mapping, Sequence
from typing import Any

import msgspec

from groundstation.config.config_file import ConfigFile, choose_path, read_config
from groundstation.config.defaults import DEFAULT_ENDPOINT, ENDPOINT_VARIABLE
from groundstation.config.settings import ROWS, Settings, ThemeName
from groundstation.input.keymap import Keymap
from groundstation.input.keymap_file import load_keymap, rebind
from link.endpoint import EndpointError, parse_endpoint
from link.toml.errors import suggest


class Effective(msgspec.Struct, frozen=True):
    """The settings of one run."""

    settings: Settings
    sources: Mapping[str, str]
    """Setting -> where its value is from; a setting that is missing has its default."""


def load_config(option: str | None, environment: Mapping[str, str], reserved: Container[str] = ()) -> ConfigFile | None:
    """Return the file that --config or MAVHELM_CONFIG names, or the user's own if there is one. Raises ConfigError."""
    path, named = choose_path(option, environment)
    return read_config(path, reserved) if named or path.exists() else None


def merge(file: ConfigFile | None, environment: Mapping[str, str], options: Mapping[str, Any]) -> Effective:
    """Return the settings in force. `options` are those of the command line that were given.

    Raises EndpointError for MAVHELM_ENDPOINT.
    """
    values: dict[str, Any] = {}
    sources: dict[str, str] = {}
    if file is not None:
        values |= file.values
        sources |= {name: file.place(name) for name in file.values}
    for name, (variable, value) in _from_environment(environment, options).items():
        values[name], sources[name] = value, variable
    for name, value in options.items():
        option = ROWS[name].option
        values[name], sources[name] = value, option.flag if option is not None else "command line"
    if "keymap" in options:  # a key map that was asked for is not changed by the file
        values.pop("keys", None)
        sources.pop("keys", None)
    return Effective(msgspec.convert(values, Settings), sources)


def _from_environment(environment: Mapping[str, str], given: Collection[str]) -> dict[str, tuple[str, Any]]:
    """Return setting -> variable and value. An empty variable counts as none (https://no-color.org)."""
    found: dict[str, tuple[str, Any]] = {}
    if "open" not in given and (endpoints := environment_endpoints(environment)):
        found["open"] = ENDPOINT_VARIABLE, endpoints
    if environment.get("NO_COLOR"):
        found["theme"] = "NO_COLOR", ThemeName.NO_COLOUR
    return found


def environment_endpoints(environment: Mapping[str, str]) -> list[str]:
    """Return the endpoints and names in MAVHELM_ENDPOINT. Raises EndpointError, which names the variable."""
    texts = environment.get(ENDPOINT_VARIABLE, "").split()
    try:
        for text in texts:
            if ":" in text:
                parse_endpoint(text)
    except EndpointError as error:
        raise EndpointError(f"{ENDPOINT_VARIABLE}: {error}") from error
    return texts


def build_keymap(settings: Settings) -> Keymap:
    """Return the key map with the changes of [keys]. Raises KeymapError."""
    base = load_keymap(settings.keymap)
    return rebind(base, settings.keys) if settings.keys else base


def resolve_endpoints(texts: str | Sequence[str], settings: Settings) -> list[str]:
    """Return the endpoints that the texts are or name. Raises EndpointError."""
    endpoints: list[str] = []
    for text in [texts] if isinstance(texts, str) else texts:
        named = settings.endpoints.get(text)
        if named is not None:
            endpoints += [named] if isinstance(named, str) else named
        else:
            endpoints.append(text)
            _check_endpoint(text, settings.endpoints)
    return endpoints


def _check_endpoint(text: str, names: Collection[str]) -> None:
    if ":" not in text and "/" not in text:
        hint = f", nor a name of [endpoints]; {suggest(text, names)}" if names else " (mavhelm --help lists them)"
        raise EndpointError(f"{text!r} is not an endpoint such as {DEFAULT_ENDPOINT}{hint}")
    parse_endpoint(text)
