"""A table of cases that one test goes through, where each takes a few milliseconds.

pytest takes 10 to 20 ms for each item of a test with parameters, and each of its workers collects all of them.
"""

from __future__ import annotations

import functools
import inspect
import traceback
from collections.abc import Callable, Iterable
from typing import Any

import pytest


def each_row(
    names: str | tuple[str, ...], rows: Iterable[Any], ids: Callable[[Any], object] = repr
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Call the test with each row as `pytest.mark.parametrize` does, in one item; name all rows that fail.

    The other fixtures of the test are the same for all rows.
    """
    table = list(rows)
    keys = tuple(each.strip() for each in names.split(",")) if isinstance(names, str) else names

    def decorate(test: Callable[..., None]) -> Callable[..., None]:
        @functools.wraps(test)
        def run(*args: Any, **fixtures: Any) -> None:
            assert table, "no rows"
            failed = []
            for row in table:
                values = (row,) if len(keys) == 1 else row
                try:
                    test(*args, **fixtures, **dict(zip(keys, values, strict=True)))
                except (Exception, pytest.fail.Exception) as error:  # all rows are told, not the first one alone
                    place = traceback.extract_tb(error.__traceback__)[-1]
                    failed.append(f"{', '.join(str(ids(value)) for value in values)}: {error!r} in line {place.lineno}")
            assert not failed, f"{len(failed)} of {len(table)} rows fail:\n" + "\n".join(failed)

        signature = inspect.signature(test)
        others = [each for name, each in signature.parameters.items() if name not in keys]
        run.__signature__ = signature.replace(parameters=others)  # type: ignore[attr-defined]  # pytest reads it
        return run

    return decorate
