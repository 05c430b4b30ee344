"""Checks the values of groundstation.toml: which keys, which values, and what they mean together."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Container, Iterator, Mapping
from typing import Any

import msgspec

from groundstation.config.groups import NAME as GROUP_NAME
from groundstation.config.groups import GroupError, parse_group
from groundstation.config.settings import ROWS, TEXTS
from groundstation.input.keymap import KeymapError
from groundstation.input.keymap_file import load_keymap, parse_bindings, rebind
from groundstation.input.pad_mapping import find_pad_conflict, find_pad_problems
from link.endpoint import EndpointError, parse_endpoint, parse_endpoints
from link.toml.errors import suggest

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.-]*")
"""A name of an endpoint: without `:` and `/`, which endpoints have, and not like an option."""

SHOWN = 40
"""Characters of a wrong value that an error shows."""

Problem = tuple[tuple[str, ...], str]
"""The key, table by table, and the line for the user without the place."""


def find_problems(values: Mapping[str, Any], reserved: Container[str]) -> Iterator[Problem]:
    """Yield every mistake; no endpoint may have one of the names in `reserved`."""
    for name, value in values.items():
        if name not in ROWS:
            yield (name,), f"{name}: unknown setting; {suggest(name, ROWS)}"
        elif name in TABLES and isinstance(value, dict):
            for key, each in value.items():
                yield from (
                    ((name, key), f"{name}.{key}: {what}") for what in _entry_problems(name, key, each, reserved)
                )
        elif name in TABLES:
            yield (name,), f"{name}: must be a table, [{name}]"
        else:
            yield from (((name,), f"{name}: {what}") for what in _value_problems(name, value, values))
    yield from _together(values)


def _entry_problems(table: str, key: str, value: Any, reserved: Container[str]) -> list[str]:
    """Return the mistakes in one entry of a table. TOML takes each line below [table] as an entry of it."""
    found = list(TABLES[table](key, value, reserved))
    return [f"{key} is a setting: move its line above [{table}]"] if found and key in ROWS else found


def _together(values: Mapping[str, Any]) -> Iterator[Problem]:
    """Check [pad] as a whole, and the key map with the changes of [keys]. What is wrong alone is reported elsewhere."""
    pad = values.get("pad")
    if isinstance(pad, dict) and (conflict := find_pad_conflict(pad)):
        yield ("pad",), f"pad: {conflict}"
    keys, base = values.get("keys"), values.get("keymap", "standard")
    if not isinstance(keys, dict) or not isinstance(base, str):
        return
    try:
        keymap = load_keymap(base)
        for action, value in keys.items():
            parse_bindings({action: value})
    except KeymapError:
        return
    try:
        rebind(keymap, keys)
    except KeymapError as error:
        yield ("keys",), f"keys: {error}"


def _value_problems(name: str, value: Any, values: Mapping[str, Any]) -> Iterator[str]:
    row = ROWS[name]
    try:
        row.convert(value)
    except msgspec.ValidationError:
        hint = f"; {suggest(value, row.choices)}" if row.choices and isinstance(value, str) else ""
        yield f"{row.refuse(value, _show(value))}{hint}"
        return
    if name == "open":
        yield from _open_problems(value, values.get("endpoints", {}))
    elif name == "keymap":
        yield from _keymap_problems(value)


def _show(value: Any) -> str:
    text = json.dumps(value, default=str, ensure_ascii=False)
    return text if len(text) <= SHOWN else f"{text[:SHOWN]}..."


def _open_problems(value: str | list[str], endpoints: Any) -> Iterator[str]:
    for text in [value] if isinstance(value, str) else value:
        if isinstance(endpoints, dict) and text in endpoints:
            continue
        try:
            parse_endpoint(text)
        except EndpointError as error:
            known = isinstance(endpoints, dict) and endpoints and ":" not in text
            yield f"no name of [endpoints]: {text!r}; {suggest(text, endpoints)}" if known else str(error)


def _endpoint_problems(name: str, value: Any, reserved: Container[str]) -> Iterator[str]:
    if not NAME.fullmatch(name):
        yield "a name has letters, digits, - _ . only, and begins with a letter or digit"
    if name in reserved:
        yield f"`mavhelm {name}` is a command; choose another name"
    texts = [value] if isinstance(value, str) else value
    if not isinstance(texts, list) or not texts or not all(isinstance(text, str) for text in texts):
        yield f"{_show(value)} is not {TEXTS}"
        return
    try:
        parse_endpoints(texts)
    except EndpointError as error:
        yield str(error)


def _group_problems(name: str, value: Any, reserved: Container[str]) -> Iterator[str]:
    if not GROUP_NAME.fullmatch(name):
        yield "a name has letters, digits, - _ . only, and begins with a letter"
    try:
        parse_group(msgspec.convert(value, str | tuple[str, ...]))
    except msgspec.ValidationError:
        yield f"{_show(value)} is not {TEXTS}"
    except GroupError as error:
        yield str(error)


def _key_problems(action: str, value: Any, reserved: Container[str]) -> Iterator[str]:
    try:
        parse_bindings({action: value})
    except KeymapError as error:
        yield str(error)


def _keymap_problems(name: str) -> Iterator[str]:
    try:
        load_keymap(name)
    except KeymapError as error:
        yield str(error)


def _pad_problems(name: str, value: Any, reserved: Container[str]) -> Iterator[str]:
    yield from find_pad_problems(name, value)


TABLES: dict[str, Callable[[str, Any, Container[str]], Iterator[str]]] = {
    "endpoints": _endpoint_problems,
    "groups": _group_problems,
    "keys": _key_problems,
    "pad": _pad_problems,
}
"""Table in the file -> the check of one entry."""
