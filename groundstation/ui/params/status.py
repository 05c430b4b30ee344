"""How the requests of the Parameters screen stand, in one line."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from groundstation.natural_order import natural_key
from groundstation.ui.params.edit.checks import needs_care
from groundstation.ui.params.edit.pending import PendingChange
from groundstation.views.params import ParamInfo, ParamPage
from groundstation.views.requests import RequestLine

MAX_GAPS = 6
"""Missing indexes that are named."""
MAX_NAMES = 4
"""Names of a write that are listed."""


def status_text(page: ParamPage | None, last_write: str, *, edited: bool) -> str:
    """Return what runs, else what is missing, else how the last request ended; `edited`: only a failure."""
    if page is None:
        return ""
    if page.running:
        return " · ".join(map(_running_text, page.running))
    if page.missing:
        return missing_text(page.missing, page.gaps)
    if not page.ended:
        return ""
    last = page.ended[-1]
    if edited and last.state == "accepted":
        return ""
    return last_write if last_write and last.what.startswith("set ") else _ended_text(last)


def missing_text(missing: int, gaps: Sequence[int]) -> str:
    """Return which parameters have not arrived."""
    indexes = ", ".join(map(str, gaps[:MAX_GAPS])) + (" …" if missing > MAX_GAPS else "")
    return f"{missing} missing (index {indexes}): R asks for them"


def written_text(line: RequestLine, done: Sequence[str], others: Sequence[str]) -> str:
    """Return how a write ended, and after a refusal what stands and which of the others were not tried."""
    if line.state == "accepted":
        return f"{line.what}: {len(done)} of {len(done)} confirmed · u makes the old values pending again"
    stands = f" · set: {_listed(done)}" if done else ""
    left = others[1:]
    return f"{line.state}: {line.detail or line.what}{stands}" + (f" · not tried: {_listed(left)}" if left else "")


def _listed(names: Sequence[str]) -> str:
    more = len(names) - MAX_NAMES
    return ", ".join(names[:MAX_NAMES]) + (f" and {more} more" if more > 0 else "")


def _running_text(line: RequestLine) -> str:
    return f"{line.what} {line.done}" + (f"/{line.total}" if line.total is not None else "")


def _ended_text(line: RequestLine) -> str:
    """Return how a request ended; a failure begins with the reason, which must be seen on a narrow screen, too."""
    if line.state == "accepted":
        return f"{line.what}: {line.detail or 'done'}"
    return f"{line.state}: {line.detail or line.what}"


def question_text(pending: Mapping[str, PendingChange], infos: Mapping[str, ParamInfo], *, armed: bool) -> str:
    """Return what a write would do; while the vehicle is armed with the names that need care."""
    text = f"write {len(pending)} {'change' if len(pending) == 1 else 'changes'} to the vehicle"
    if not armed:
        return text
    care = [name for name in sorted(pending, key=natural_key) if needs_care(infos.get(name), name)]
    return f"{text}, which is ARMED" + (f" (care: {_listed(care)})" if care else "")
