"""Exit codes of the verbs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from enum import IntEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # it loads the dialect, which completion in a shell does without
    from groundstation.vehicles.requests.requests import RequestReport


class ExitCode(IntEnum):
    """What a verb's exit code means; 128 and a signal's number after a signal."""

    DONE = 0
    """Done, and confirmed by the vehicle."""
    BROKEN = 1
    """This program failed."""
    USAGE = 2
    """A mistake in the arguments or in a file."""
    NO_VEHICLE = 3
    """No vehicle was heard within --wait."""
    REFUSED = 4
    """The vehicle refused, or our role does not allow it; the reason was printed."""
    NO_ANSWER = 5
    """No answer after all tries."""
    NOT_IN_CONTROL = 6
    """Refused, because another ground station is in control."""
    DIFFERS = 7
    """Something differs, is not so, is not ready, or there is no such thing."""
    PARTLY = 8
    """Partly done; the rest was printed."""


_WORST_FIRST = (
    ExitCode.BROKEN,
    ExitCode.USAGE,
    ExitCode.NO_VEHICLE,
    ExitCode.NO_ANSWER,
    ExitCode.REFUSED,
    ExitCode.NOT_IN_CONTROL,
    ExitCode.PARTLY,
    ExitCode.DIFFERS,
    ExitCode.DONE,
)
"""Of several vehicles: first those of which least is known."""


def worst_code(codes: Iterable[int]) -> ExitCode:
    """Return the worst of the codes of several vehicles; there must be one."""
    return min(map(ExitCode, codes), key=_WORST_FIRST.index)


class VerbError(Exception):
    """A verb cannot go on; the message is one line."""

    def __init__(self, code: ExitCode, text: str) -> None:
        super().__init__(text)
        self.code = code


_CODES: Mapping[str, ExitCode] = {
    "ACCEPTED": ExitCode.DONE,
    "REFUSED": ExitCode.REFUSED,
    "NO_ANSWER": ExitCode.NO_ANSWER,
    "CANCELLED": ExitCode.NO_ANSWER,
}
"""Name of a RequestState -> code."""


def code_of(report: RequestReport, other_driver: int | None = None) -> ExitCode:
    """Return the exit code for a request that has ended.

    `other_driver` is another ground station in control of a vehicle that was to change something.
    """
    code = _CODES[report.state.name]
    return ExitCode.NOT_IN_CONTROL if code is ExitCode.REFUSED and other_driver is not None else code
