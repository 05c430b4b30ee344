"""Exit codes of the verbs."""

from __future__ import annotations

from enum import IntEnum

from groundstation.vehicles.requests import RequestReport, RequestState


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
    """The vehicle refused; its reason was printed."""
    NO_ANSWER = 5
    """No answer after all tries."""
    NOT_IN_CONTROL = 6
    """Refused, because another ground station is in control."""
    DIFFERS = 7
    """Something differs, is not so, is not ready, or there is no such thing."""
    PARTLY = 8
    """Partly done; the rest was printed."""


class VerbError(Exception):
    """A verb cannot go on; the message is one line."""

    def __init__(self, code: ExitCode, text: str) -> None:
        super().__init__(text)
        self.code = code


_CODES = {
    RequestState.ACCEPTED: ExitCode.DONE,
    RequestState.REFUSED: ExitCode.REFUSED,
    RequestState.NO_ANSWER: ExitCode.NO_ANSWER,
    RequestState.CANCELLED: ExitCode.NO_ANSWER,
}


def code_of(report: RequestReport) -> ExitCode:
    """Return the exit code for a request that has ended."""
    return _CODES[report.state]
