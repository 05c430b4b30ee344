"""Names that a user may have meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

MAX_LISTED = 40
"""Names that are listed where none is near."""


def describe_nearest(word: str, known: Iterable[str], *, every: bool = False) -> str:
    """Return ": did you mean ...?", with `every` else ": there are ...", or an empty text."""
    names = list(known)
    near = difflib.get_close_matches(word, names, n=2, cutoff=0.6)
    near += [name for name in names if word and name.startswith(word) and name not in near][: 2 - len(near)]
    if near:
        return f": did you mean {' or '.join(near)}?"
    return f": there are {', '.join(names)}" if every and len(names) <= MAX_LISTED else ""
