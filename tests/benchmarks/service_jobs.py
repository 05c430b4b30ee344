"""The jobs of `services`: the requests to a vehicle, by our clients and by the bare ones, and their bytes."""

from __future__ import annotations

import asyncio
import socket
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager

from dialects import messages as m
from dialects.enums import Command, MissionResult, MissionType
from link.services.ftp.protocol import MAX_DATA, FtpOpcode, FtpPacket
from link.services.mission.items import MissionItem, to_message
from tests.benchmarks import bare_services
from tests.benchmarks.bare_services import GROUND, VEHICLE
from tests.benchmarks.figures import BenchmarkError
from tests.benchmarks.station import Station
from tests.benchmarks.traffic import framed

ITEMS = 200
LOG_NAME, DRIVEN_LOG = "00000001.tlog", "00000002.tlog"
PARAMS, UPLOAD, DOWNLOAD, FILE = "parameter list", f"mission of {ITEMS}, up", f"mission of {ITEMS}, down", "log"
DRIVEN_FILE = "log while somebody drives"
RELATIVE_ALTITUDE = 6
"""MAV_FRAME_GLOBAL_RELATIVE_ALT_INT"""
WITHIN = 1200.0
"""s for one job; a megabyte takes 200 s at 57600 baud."""

Times = dict[str, list[float]]
"""Job -> s of each round."""


def mission() -> list[MissionItem]:
    """Return waypoints, all different."""
    return [
        MissionItem(
            Command.NAV_WAYPOINT,
            RELATIVE_ALTITUDE,
            (1.0, 0.0, 0.0, 0.0),
            500_000_000 + number,
            80_000_000 + number,
            0.0,
        )
        for number in range(ITEMS)
    ]


# ---- by our own clients ----


async def fetch_params(station: Station, times: Times, name: str = PARAMS) -> None:
    """Read all parameters."""
    with _clocked(times, name):
        station.params.fetch(_now())
        await station.until(lambda: not station.params.fetching, name, WITHIN)
    if not station.params.complete:
        raise BenchmarkError("the parameter list did not come")


async def upload(station: Station, times: Times) -> None:
    """Upload the mission."""
    await _mission_job(station, times, UPLOAD, lambda: station.missions.upload(mission(), MissionType.MISSION, _now()))


async def download(station: Station, times: Times) -> None:
    """Download the mission."""
    await _mission_job(station, times, DOWNLOAD, lambda: station.missions.download(MissionType.MISSION, _now()))


async def fetch_log(station: Station, times: Times, size: int, job: str = FILE, name: str = LOG_NAME) -> None:
    """Download a log of `size` bytes."""
    with _clocked(times, job):
        station.files.download(f"/logs/{name}", _now())
        await station.until(lambda: not station.files.busy, job, WITHIN)
    (outcome,) = station.files.outcomes()
    if len(outcome.data) != size:
        raise BenchmarkError(f"{len(outcome.data)} of {size} bytes of the log came: {outcome.error}")


async def _mission_job(station: Station, times: Times, name: str, begin: Callable[[], None]) -> None:
    with _clocked(times, name):
        begin()
        await station.until(lambda: not station.missions.busy, name, WITHIN)
    (outcome,) = station.missions.outcomes()
    if not outcome.done:
        raise BenchmarkError(f"{name}: {outcome.result}")


def _now() -> float:
    return asyncio.get_running_loop().time()


# ---- by the bare clients ----


def bare_round(port: int, times: Times, size: int) -> None:
    """Run each job once."""
    items = [to_message(item, number, MissionType.MISSION, VEHICLE) for number, item in enumerate(mission())]
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.connect(("127.0.0.1", port))
        line = bare_services.Line(sock, GROUND)
        with _clocked(times, PARAMS):
            bare_services.fetch_params(line)
        with _clocked(times, UPLOAD):
            bare_services.upload(line, items)
        with _clocked(times, DOWNLOAD):
            bare_services.download(line)
        with _clocked(times, FILE):
            got = bare_services.fetch_file(line)
    if got != size:
        raise BenchmarkError(f"the bare pair lost {size - got} of {size} bytes")


@contextmanager
def _clocked(times: Times, name: str) -> Iterator[None]:
    start = time.monotonic()
    yield
    times.setdefault(name, []).append(time.monotonic() - start)


# ---- the bytes ----


def wire_bytes(station: Station, size: int) -> dict[str, int]:
    """Job -> bytes that must travel, of both directions where one waits for the other."""
    values = [
        m.ParamValue(each.name.encode(), each.value, each.kind, len(station.params.params), each.index or 0)
        for each in station.params.params.values()
    ]
    items = [to_message(item, number, MissionType.MISSION, GROUND) for number, item in enumerate(mission())]
    requests = [m.MissionRequestInt(*GROUND, number, MissionType.MISSION) for number in range(ITEMS)]
    count = m.MissionCount(*GROUND, ITEMS, MissionType.MISSION)
    ack = m.MissionAck(*GROUND, MissionResult.ACCEPTED, MissionType.MISSION)
    ask = m.MissionRequestList(*GROUND, MissionType.MISSION)
    return {
        PARAMS: _bytes([m.ParamRequestList(*VEHICLE), *values]),
        UPLOAD: _bytes([count, *requests, *items, ack]),
        DOWNLOAD: _bytes([ask, count, *requests, *items]),
        FILE: log_bytes(size),
    }


def log_bytes(size: int) -> int:
    """Return the bytes of a log of `size` bytes on the wire."""
    return _bytes(_pieces(size))


def _pieces(size: int) -> Iterator[m.Message]:
    for offset in range(0, size, MAX_DATA):
        data = bytes([255]) * min(MAX_DATA, size - offset)
        yield FtpPacket(1, FtpOpcode.ACK, 1, data, offset, FtpOpcode.BURST).message(*GROUND)


def _bytes(messages: Iterable[m.Message]) -> int:
    return sum(len(framed(message, 1)) for message in messages)
