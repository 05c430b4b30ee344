"""What a running station tells about itself: its vehicles, links and screens; for lines that name several stations."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Sequence

import msgspec

from groundstation.station_socket.connect import NoStationError, connect, running_stations
from groundstation.station_socket.folder import FolderError
from groundstation.station_socket.hello import ABOUT, Hello, encode
from link.endpoint import EndpointError, parse_endpoint, parse_endpoints

VERSION = 1
"""Of the answer below."""

ANSWER_WITHIN = 0.3
"""s for one station to answer; one that hangs is named by its process id alone."""

MAX_ANSWER = 1 << 16
"""Bytes of the largest answer."""

ATTACH = "mavhelm attach"
"""What to do where a station of one's own has the port or device that a screen opens."""

MAX_NAMES = 3
"""Vehicles that are named; a fleet has hundreds."""


class About(msgspec.Struct, frozen=True, tag=True):
    """From the station, first and last."""

    vehicles: tuple[str, ...]
    """Names, the one that it drives first."""
    endpoints: tuple[str, ...]
    screens: tuple[str, ...]
    """e.g. "screen on pts/3"."""


encode_about = encode
_decode = msgspec.msgpack.Decoder(About).decode


def ask_about(pid: int, within: float = ANSWER_WITHIN) -> About | None:
    """Return what the station with this process id tells; None if it does not answer `within` s, or is older."""
    try:
        with connect(pid, Hello(ABOUT, VERSION), within) as sock:
            return _decode(sock.recv(MAX_ANSWER))
    except (NoStationError, FolderError, OSError, msgspec.DecodeError):
        return None


def describe_stations(pids: Sequence[int]) -> str:
    """Return e.g. "3240 (Rover 1, udpin:0.0.0.0:14550, screen on pts/3), 7147 (no vehicle, no link, no screen)"."""
    return ", ".join(_describe(pid, ask_about(pid)) for pid in pids)


def find_holder(endpoint: str) -> int | None:
    """Return the process id of another station of this user that has the port or device of an endpoint open."""
    with contextlib.suppress(FolderError):
        for pid in running_stations():
            about = ask_about(pid) if pid != os.getpid() else None
            if about is not None and any(_is_the_same(endpoint, theirs) for theirs in about.endpoints):
                return pid
    return None


def explain_taken(problem: str, remedy: str) -> str:
    """Return why a link cannot be opened (LinkError), naming a station of this user that has its port or device.

    `remedy` is what to do then, with {pid}.
    """
    endpoint, _, why = problem.partition(": ")
    if "in use" not in why and "another program uses" not in why:
        return problem
    pid = find_holder(endpoint)
    what = problem.partition(";")[0].partition(" (`")[0]
    return problem if pid is None else f"{what}; a station of yours ({pid}) has it: {remedy.format(pid=pid)}"


def _describe(pid: int, about: About | None) -> str:
    if about is None:
        return str(pid)
    vehicles = [*about.vehicles[:MAX_NAMES], *(["..."] if len(about.vehicles) > MAX_NAMES else [])]
    parts = [*(vehicles or ["no vehicle"]), *(about.endpoints or ["no link"]), *(about.screens or ["no screen"])]
    return f"{pid} ({', '.join(parts)})"


def _by_device(endpoint: str) -> str:
    """Return an endpoint with the device in place of a link to it, as /dev/serial0 and /dev/serial/by-id/... are."""
    found = parse_endpoint(endpoint)
    return found.text.replace(found.path, os.path.realpath(found.path), 1) if found.path else found.text


def _is_the_same(one: str, other: str) -> bool:
    """Return whether two endpoints of this machine cannot be open at once; a serial port may have several names."""
    try:
        devices = [_by_device(text) for text in (one, other)]
    except EndpointError:  # of a station that knows other endpoints
        return False
    try:
        parse_endpoints(devices)
    except EndpointError:
        return True
    return False
