"""Reads TOML files, and other small files whole; any error is one line. The caller interprets the content."""

from __future__ import annotations

import errno
import os
import re
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import tomllib  # imported where a file is read: it takes 5 ms of each start

MAX_INTEGER = 2**63 - 1
"""TOML's own limit for integers, which Python does not enforce."""
MAX_DEPTH = 32
"""Nested tables and lists. No settings file has more than four levels; without a limit a dotted key is as deep as it is
long, and code that walks it ends with a RecursionError."""
TOO_DEEP = "lists or tables are nested too deep"

TWICE = re.compile(r"Cannot declare \((?P<names>.*?)\) twice \((?P<where>at line \d+)")
OVERWRITES = "Cannot overwrite a value"


class TomlError(Exception):
    """The file cannot be read. The text is one line: file, error, remedy."""


def read_toml(path: str | Path) -> dict[str, Any]:
    """Return the tables of a file. Raises TomlError."""
    return parse_toml(read_text(path), str(path))


def read_text(path: str | Path, limit: int | None = None) -> str:
    """Return the text of a file; with `limit` only of a regular file of at most so many bytes. Raises TomlError."""
    try:
        data = Path(path).read_bytes() if limit is None else read_regular_file(path, limit)
        return data.decode("utf-8-sig")  # some editors begin a file with a byte order mark
    except IsADirectoryError:
        raise TomlError(f"{path}: is a directory; name a file in it") from None
    except OSError as error:
        raise TomlError(f"{path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        what = f"byte {error.start + 1} is not UTF-8 text"
        raise TomlError(f"{path}: {what}; save the file as UTF-8, or name another one") from error


def parse_toml(text: str, name: str) -> dict[str, Any]:
    """Return the tables of a TOML text. Raises TomlError."""
    import tomllib

    try:
        found = tomllib.loads(text)
    except RecursionError:
        raise TomlError(f"{name}: {TOO_DEEP}") from None
    except tomllib.TOMLDecodeError as error:
        raise TomlError(f"{name}: {_explain(error)}") from error
    except ValueError:  # of int()
        raise TomlError(f"{name}: a number with thousands of digits") from None
    if _too_deep(found):
        raise TomlError(f"{name}: {TOO_DEEP}")
    return found


def _explain(error: tomllib.TOMLDecodeError) -> str:
    """Return tomllib's error, with a remedy for tables that were pasted twice."""
    text = str(error)
    if twice := TWICE.match(text):
        table = ".".join(re.findall(r"'([^']*)'", twice["names"]))
        return f"[{table}] exists already, and again {twice['where']}; move its lines below the first one"
    if text.startswith(OVERWRITES):
        return f"the key is set already, {text.removeprefix(OVERWRITES).strip(' ()')}; remove one of them"
    return text


def _too_deep(table: dict[str, Any]) -> bool:
    level: list[Any] = [table]
    for _ in range(MAX_DEPTH):
        insides = (each.values() if isinstance(each, dict) else each for each in level)
        level = [each for inside in insides for each in inside if isinstance(each, dict | list)]
    return bool(level)


def find_unsupported(value: Any, at: str = "") -> Iterator[str]:
    """Yield a line for each value that TOML allows and no setting accepts: over 64 bits, or with NUL."""
    if isinstance(value, dict):
        for key, inside in value.items():
            yield from find_unsupported(inside, f"{at}.{key}" if at else key)
    elif isinstance(value, list):
        for index, inside in enumerate(value):
            yield from find_unsupported(inside, f"{at}[{index}]")
    elif isinstance(value, str) and "\0" in value:
        yield f"{at}: contains the character NUL; remove it"
    elif isinstance(value, int) and abs(value) > MAX_INTEGER:
        yield f"{at}: the number is too large"


def read_regular_file(path: str | Path, limit: int) -> bytes:
    """Return the content of a regular file of at most `limit` bytes. Raises OSError.

    It never blocks on a pipe, and never reads a device without an end.
    """
    with open(path, "rb", opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK)) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise OSError(errno.EINVAL, "is not a regular file", str(path))
        data = file.read(limit + 1)
    if len(data) > limit:
        raise OSError(errno.EFBIG, f"is larger than {limit} bytes", str(path))
    return data
