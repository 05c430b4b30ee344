"""A TOML file as it stands there, whatever is in it: what cannot be read is one line. What it means is its reader's."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

MAX_INTEGER = 2**63 - 1
"""TOML's own bound for whole numbers, which Python does not keep."""
MAX_DEPTH = 32
"""Tables and lists in each other. No file of ours has more than four; without a bound a dotted key goes as deep as it
is long, and whoever walks down it ends with a RecursionError."""
TOO_DEEP = "brackets in brackets, or tables in tables, too deep to be meant"

TWICE = re.compile(r"Cannot declare \((?P<names>.*?)\) twice \((?P<where>at line \d+)")
OVERWRITES = "Cannot overwrite a value"


class TomlError(Exception):
    """The file cannot be read. The text is one line: file, what is wrong, what to do."""


def read_toml(path: str | Path) -> dict[str, Any]:
    """The tables of a file. Raises TomlError."""
    try:
        text = Path(path).read_text(encoding="utf-8-sig")  # some editors begin a file with a mark
    except IsADirectoryError:
        raise TomlError(f"{path}: is a folder; name a file in it") from None
    except OSError as error:
        raise TomlError(f"{path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        what = f"byte {error.start + 1} is no text in UTF-8"
        raise TomlError(f"{path}: {what}; save the file as UTF-8, or name another one") from error
    return parse_toml(text, str(path))


def parse_toml(text: str, name: str) -> dict[str, Any]:
    """The tables of a file's text. Raises TomlError."""
    try:
        found = tomllib.loads(text)
    except RecursionError:
        raise TomlError(f"{name}: {TOO_DEEP}") from None
    except tomllib.TOMLDecodeError as error:
        raise TomlError(f"{name}: {_in_words(error)}") from error
    except ValueError:  # of int()
        raise TomlError(f"{name}: a number of thousands of digits, which nothing takes") from None
    if _too_deep(found):
        raise TomlError(f"{name}: {TOO_DEEP}")
    return found


def _in_words(error: tomllib.TOMLDecodeError) -> str:
    """What tomllib says, and what to do where somebody has put a table of a guide at the end of a file."""
    words = str(error)
    if twice := TWICE.match(words):
        table = ".".join(re.findall(r"'([^']*)'", twice["names"]))
        return f"[{table}] is there already, and again {twice['where']}; put its lines below the first one"
    if words.startswith(OVERWRITES):
        return f"a key that is set already, {words.removeprefix(OVERWRITES).strip(' ()')}; leave one out"
    return words


def _too_deep(table: dict[str, Any]) -> bool:
    level: list[Any] = [table]
    for _ in range(MAX_DEPTH):
        insides = (each.values() if isinstance(each, dict) else each for each in level)
        level = [each for inside in insides for each in inside if isinstance(each, dict | list)]
    return bool(level)


def find_unsupported(value: Any, at: str = "") -> Iterator[str]:
    """What TOML can say and nothing takes: numbers of more than 64 bits, and NUL in a text. A line each."""
    if isinstance(value, dict):
        for key, inside in value.items():
            yield from find_unsupported(inside, f"{at}.{key}" if at else key)
    elif isinstance(value, list):
        for index, inside in enumerate(value):
            yield from find_unsupported(inside, f"{at}[{index}]")
    elif isinstance(value, str) and "\0" in value:
        yield f"{at}: holds the character NUL; leave it out"
    elif isinstance(value, int) and abs(value) > MAX_INTEGER:
        yield f"{at}: a number too large to be meant"
