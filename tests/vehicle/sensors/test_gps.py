from __future__ import annotations

import asyncio
import contextlib
import os
import pty
import shutil
import tty
from collections.abc import AsyncIterator, Callable
from pathlib import Path

import pytest

from tests.ports import free_port
from vehicle.sensors import gps
from vehicle.sensors.gps import GpsdClient, GpsSettings

RECORDED = Path(__file__).with_name("gpsd_3_22.jsonl").read_bytes()


class Server:
    """Serves bytes to whoever asks for the watch, over real TCP."""

    def __init__(self, stream: bytes, *, hang_up: bool = False) -> None:
        self.stream = stream
        self.hang_up = hang_up
        self.asked: list[bytes] = []
        self._open: list[asyncio.StreamWriter] = []

    @contextlib.asynccontextmanager
    async def running(self, port: int = 0) -> AsyncIterator[int]:
        server = await asyncio.start_server(self._serve, "127.0.0.1", port)
        try:
            yield server.sockets[0].getsockname()[1]
        finally:
            server.close()
            for writer in self._open:
                writer.close()
            await server.wait_closed()

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._open.append(writer)
        self.asked.append(await reader.readline())
        writer.write(self.stream)
        await writer.drain()
        if self.hang_up:
            writer.close()


async def until(holds: Callable[[], object]) -> None:
    """Let the loop run until it holds."""
    async with asyncio.timeout(60):
        while not holds():  # noqa: ASYNC110 - what is waited for has no event
            await asyncio.sleep(0.005)


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gps, "RETRY", (0.01, 0.02))


async def test_a_recorded_stream_over_tcp() -> None:
    server = Server(RECORDED)
    async with server.running() as port:
        source = GpsdClient(GpsSettings(port=port), clock=lambda: 100.0)
        await until(lambda: (reading := source.latest(100.0)) and reading.sky.satellites and reading.fix.velocity_east)
        assert server.asked == [b'?WATCH={"enable":true,"json":true};\n']
        reading = source.latest(103.0)
        assert reading is not None
        assert (reading.fix.latitude, reading.sky.satellites) == (52.5163, 4)
        assert source.latest(103.1) is None, "a fix must not count for more than 3 s"
        assert source.fault is None
        source.close()


@pytest.mark.usefixtures("quick")
async def test_a_gpsd_that_is_not_there_is_found_when_it_comes() -> None:
    port = free_port()
    source = GpsdClient(GpsSettings(port=port))
    await until(lambda: source.fault)
    assert source.fault is not None
    assert source.fault.startswith(f"gpsd at 127.0.0.1:{port}: ")
    assert source.latest(0.0) is None
    async with Server(RECORDED).running(port):
        await until(lambda: source.latest(asyncio.get_running_loop().time()))
        assert source.fault is None
        source.close()


@pytest.mark.usefixtures("quick")
async def test_a_connection_that_is_lost_is_made_again() -> None:
    server = Server(RECORDED, hang_up=True)
    async with server.running() as port:
        source = GpsdClient(GpsSettings(port=port))
        await until(lambda: len(server.asked) >= 3)
        source.close()


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize(
    "noise", [b"x" * 200_000, b"\x00\xff\n" * 1000, b'{"class":"TPV"'], ids=["no end", "bytes", "half"]
)
async def test_noise_ends_in_a_reconnect_or_silence_and_no_exception(noise: bytes) -> None:
    server = Server(noise, hang_up=True)
    async with server.running() as port:
        source = GpsdClient(GpsSettings(port=port))
        await until(lambda: len(server.asked) >= 2)
        assert source.latest(asyncio.get_running_loop().time()) is None
        source.close()


GPSD = shutil.which("gpsd") or shutil.which("/usr/sbin/gpsd")


@pytest.mark.skipif(
    GPSD is None and "MAVHELM_CI" not in os.environ, reason="gpsd is not installed (Debian: gpsd); CI has it"
)
async def test_a_real_gpsd_with_a_receiver_on_a_terminal_line() -> None:
    master, slave = pty.openpty()
    tty.setraw(slave)
    port = free_port()
    assert GPSD is not None
    process = await asyncio.create_subprocess_exec(
        GPSD, "-N", "-n", "-S", str(port), os.ttyname(slave), stderr=asyncio.subprocess.DEVNULL
    )
    source = GpsdClient(GpsSettings(port=port))
    try:
        async with asyncio.timeout(60):
            while (reading := source.latest(asyncio.get_running_loop().time())) is None or reading.fix.fix_type < 3:
                for sentence in (
                    "GPGGA,120000.00,5230.9780,N,01322.6620,E,1,08,0.9,34.5,M,39.5,M,,",
                    "GPGSA,A,3,01,02,03,04,,,,,,,,,1.6,0.9,1.3",
                    "GPRMC,120000.00,A,5230.9780,N,01322.6620,E,002.0,090.0,211126,,,A",
                ):
                    os.write(master, nmea(sentence))
                await asyncio.sleep(0.1)
        assert reading.fix.latitude == pytest.approx(52.5163)
        assert reading.fix.longitude == pytest.approx(13.3777)
    finally:
        source.close()
        process.terminate()
        await process.wait()
        os.close(master)
        os.close(slave)


def nmea(sentence: str) -> bytes:
    checksum = 0
    for byte in sentence.encode():
        checksum ^= byte
    return f"${sentence}*{checksum:02X}\r\n".encode()
