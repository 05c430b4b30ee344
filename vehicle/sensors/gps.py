"""GpsdClient: the connection to gpsd, which keeps the newest fix and reconnects after an error."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from typing import Annotated

import msgspec

from vehicle.sensors.gpsd import GpsFix, GpsSky, parse
from vehicle.sensors.latest import LatestValue

MAX_AGE = 3.0
"""s that a fix is valid: the time of the GPS failsafe; receivers report at least once per second."""
SKY_AGE = 10.0
"""s that the satellite data are valid: gpsd reports them less often."""
RETRY = (0.2, 5.0)
"""s until the next attempt: at first, and at most; the delay doubles in between."""
LINE = 65_536
"""Bytes of the longest line: a SKY of 100 satellites has 12 000. A longer one is not from gpsd: reconnect."""
SILENCE = 60.0
"""s without a line until reconnecting: a gpsd on another machine may vanish without closing the connection."""
WATCH = b'?WATCH={"enable":true,"json":true};\n'


class GpsSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Address of gpsd."""

    host: str = "127.0.0.1"
    port: Annotated[int, msgspec.Meta(ge=1, le=65535)] = 2947


class GpsReading(msgspec.Struct, frozen=True):
    """The newest fix and the newest satellite data."""

    fix: GpsFix
    sky: GpsSky


class GpsdClient:
    """A SensorSource. Construct it in a running event loop, where its task runs until `close`."""

    def __init__(self, settings: GpsSettings, *, clock: Callable[[], float] | None = None) -> None:
        loop = asyncio.get_running_loop()
        self._settings = settings
        self._clock = clock or loop.time
        self._fix = LatestValue[GpsFix](MAX_AGE)
        self._sky = LatestValue[GpsSky](SKY_AGE)
        self._task = loop.create_task(self._run())

    @property
    def fault(self) -> str | None:
        """Why there is no connection."""
        return self._fix.fault

    def latest(self, now: float) -> GpsReading | None:
        """Return the newest reading; None without a recent report. A report without a fix counts."""
        fix = self._fix.get(now)
        return None if fix is None else GpsReading(fix, self._sky.get(now) or GpsSky())

    def close(self) -> None:
        """Cancel the task."""
        self._task.cancel()

    async def _run(self) -> None:
        wait, longest = RETRY
        while True:
            received = False
            try:
                async for line in self._lines():
                    received = self._handle(line) or received
                raise ConnectionError("the connection was closed")
            except (OSError, ValueError) as error:  # ValueError: a line that does not end
                self._fix.set_fault(OSError(f"gpsd at {self._settings.host}:{self._settings.port}: {error}"))
            wait = RETRY[0] if received else min(2 * wait, longest)
            await asyncio.sleep(wait)

    async def _lines(self) -> AsyncIterator[bytes]:
        reader, writer = await asyncio.open_connection(self._settings.host, self._settings.port, limit=LINE)
        try:
            writer.write(WATCH)
            while line := await asyncio.wait_for(reader.readline(), SILENCE):
                yield line
        finally:
            writer.close()

    def _handle(self, line: bytes) -> bool:
        """Store a report. Returns whether the line contained a fix or satellite data."""
        match parse(line):
            case GpsFix() as fix:
                self._fix.update(fix, self._clock())
                return True
            case GpsSky() as sky:
                self._sky.update(sky, self._clock())
                return True
            case None:
                return False
