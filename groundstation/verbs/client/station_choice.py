"""Finds the station that a verb goes through, and connects to it."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Callable, Sequence

import msgspec

from groundstation.station_socket.about import describe_stations
from groundstation.station_socket.connect import NoStationError, connect, running_stations
from groundstation.station_socket.folder import FolderError
from groundstation.station_socket.hello import HELLO_WITHIN, Hello, StationFailed
from groundstation.station_socket.verb_run import MAX_PRINTED, VerbReady, decode_from_station
from groundstation.verbs.common.exit_codes import ExitCode, VerbError

AUTO, ONLY, NEVER = "auto", "only", "never"
"""Values of --station; another one is a process id."""


def station_choice(text: str) -> str:
    """Check a value of --station. Raises ValueError."""
    if text in (AUTO, ONLY, NEVER) or text.isdecimal():
        return text
    raise ValueError(text)


class StationLostError(VerbError):
    """No station takes a verb, though one runs: it does not answer, or has ended."""

    def __init__(self, code: ExitCode, text: str, endpoints: Sequence[str] = ()) -> None:
        super().__init__(code, text)
        self.endpoints = endpoints
        """Those that it had open, if it has said so."""


class SeveralStationsError(VerbError):
    """Several stations run, of which none is named."""

    def __init__(self, pids: Sequence[int]) -> None:
        super().__init__(ExitCode.USAGE, "")
        self.pids = pids

    def __str__(self) -> str:
        """Return one line; asks the stations what they are, for which a stop does not wait."""
        return f"stations {describe_stations(self.pids)} run here: name one with --station PID"


class StationLink:
    """An open connection; `endpoints` are those of the station."""

    def __init__(self, sock: socket.socket, endpoints: Sequence[str]) -> None:
        self.sock, self.endpoints = sock, endpoints

    @classmethod
    def open(cls, pid: int, hello: Hello, within: float = HELLO_WITHIN) -> StationLink:
        """Connect to the station with this process id. Raises StationLostError."""
        try:
            sock = connect(pid, hello, within)
        except (NoStationError, FolderError) as error:
            raise StationLostError(ExitCode.USAGE, str(error)) from error
        try:
            answer = decode_from_station(sock.recv(MAX_PRINTED))
        except (OSError, msgspec.DecodeError):
            answer = StationFailed(f"station {pid} does not answer; --station never opens links without it")
        if isinstance(answer, VerbReady):
            sock.setblocking(False)
            return cls(sock, answer.endpoints)
        sock.close()
        line = answer.line if isinstance(answer, StationFailed) else f"station {pid} has another version"
        raise StationLostError(ExitCode.USAGE, line)


def find_station(
    choice: str,
    endpoints: Sequence[str],
    hello: Hello,
    note: Callable[[str], None],
    within: float = HELLO_WITHIN,
) -> StationLink | None:
    """Return the station that a verb goes through; None: it opens links of its own. Raises VerbError.

    That is StationLostError or SeveralStationsError where a stop has another way. With `endpoints`, those that the user
    named, a station counts only if it has them open. `note` gets why stations cannot be looked for. A station that does
    not answer `within` s is none.
    """
    if choice == NEVER:
        return None
    if choice.isdecimal():
        return StationLink.open(int(choice), hello, within)
    try:
        pids = running_stations()
    except FolderError as error:
        if choice == AUTO:
            note(f"no running station is used: {error}")
            return None
        raise VerbError(ExitCode.USAGE, str(error)) from error
    found = _matching(pids, endpoints, hello, within) if endpoints else pids
    if len(found) > 1:
        raise SeveralStationsError(found)
    if found:
        return StationLink.open(found[0], hello, within)
    if choice == ONLY:
        which = f"no station here has {' '.join(endpoints)} open" if pids else "no station runs here"
        raise VerbError(ExitCode.NO_VEHICLE, which)
    return None


def _matching(pids: Sequence[int], endpoints: Sequence[str], hello: Hello, within: float) -> list[int]:
    """Return the stations that have the endpoints open."""
    found = []
    for pid in pids:
        with contextlib.suppress(VerbError):
            link = StationLink.open(pid, hello, within)
            link.sock.close()
            if set(endpoints) <= set(link.endpoints):
                found.append(pid)
    return found
