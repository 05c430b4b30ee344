"""One line in place of a traceback where a development tool lacks the packages of an extra.

A module that imports such packages does it below `with needing("pictures"):`. A target of the Makefile that starts
them asks first: `python -m tests.extras docs mkdocs`.
"""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import NoReturn

from link.runtime.install_hint import install_command

OURS = frozenset(("dialects", "groundstation", "link", "tests", "vehicle"))
"""Packages of this tree: one of them that is missing is a fault, not an extra."""
MISSING = 2
"""Exit code."""


@contextmanager
def needing(extra: str) -> Iterator[None]:
    """End the program with one line that names `extra` if a package that is imported within is missing."""
    try:
        yield
    except ModuleNotFoundError as error:
        name = str(error.name).partition(".")[0]
        if name in OURS:
            raise
        _give_up(name, extra)


def find(extra: str, modules: Sequence[str]) -> None:
    """End the program likewise if one of `modules` is missing, of which none is imported."""
    for name in modules:
        if importlib.util.find_spec(name) is None:
            _give_up(name, extra)


def _give_up(name: str, extra: str) -> NoReturn:
    print(f"the package {name} is missing: {install_command(extra)}", file=sys.stderr)
    sys.exit(MISSING)


if __name__ == "__main__":
    find(sys.argv[1], sys.argv[2:])
