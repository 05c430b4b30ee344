"""Names that a user may have meant."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from link.endpoint import SCHEMES

MAX_LISTED = 40
"""Names that are listed where none is near."""


def describe_nearest(word: str, known: Iterable[str], *, every: bool = False) -> str:
    """Return ": did you mean ...?", with `every` else ": there are ...", or an empty text."""
    import difflib  # when it is needed: it takes 1 ms of each start

    names = list(known)
    near = difflib.get_close_matches(word, names, n=2, cutoff=0.6)
    near += [name for name in names if word and name.startswith(word) and name not in near][: 2 - len(near)]
    if near:
        return f": did you mean {' or '.join(near)}?"
    return f": there are {', '.join(names)}" if every and len(names) <= MAX_LISTED else ""


def describe_unknown(words: Sequence[str]) -> str:
    """Return one line for words that a verb does not take. The screen takes an endpoint without an option."""
    endpoint = next((word for word in words if ":" in word and word.partition(":")[0] in SCHEMES), None)
    return f"unrecognized arguments: {' '.join(words)}{f': write -e {endpoint}' if endpoint else ''}"
