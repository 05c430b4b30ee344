"""The station process: opens the links and runs the station. It has no terminal.

The screen waits until the links are open. So the modules that open them are imported first, and those that run the
station afterwards, which takes three times as long.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import socket
from collections.abc import Callable

from link.runtime import startup_gc


def main() -> int:
    """Run a station for the screen at the other end of --fd. Returns 2 if it could not start, after sending why."""
    with startup_gc.paused():
        from groundstation.host.options import open_screen_pipes, station_parser
        from groundstation.host.station_start import StartError
        from groundstation.ipc import StationReady, encode
        from groundstation.station_socket.hello import StationFailed

        def tell(message: StationReady | StationFailed) -> None:
            with contextlib.suppress(OSError):  # the screen has exited; the end of the pipe ends the station
                pipe.send(encode(message))

        pipe, watchdog, options = open_screen_pipes(station_parser())
        if options is None:
            return 0
        if options.keep:
            os.setsid()  # so that the end of the terminal ends the screen alone
        try:
            return run_station(options, lambda endpoints: tell(StationReady(endpoints)), pipe, watchdog)
        except StartError as error:
            tell(StationFailed(str(error)))
            return 2


def run_station(
    options: argparse.Namespace,
    ready: Callable[[tuple[str, ...]], None],
    pipe: socket.socket | None = None,
    watchdog: socket.socket | None = None,
) -> int:
    """Run a station to its end; return the exit code. `ready` is called with its endpoints once they are open.

    `pipe` leads to its screen, and `watchdog` as well, for the watchdog. Without a pipe it has no screen, SIGINT ends
    it like SIGTERM, and `ready` is called once programs can attach to it.

    Raises StartError.
    """
    from groundstation.host.station_start import start

    started = start(options, pipe, watchdog)
    if pipe is not None:
        ready(started.endpoints)
    from groundstation.host.station_run import run

    return run(options, pipe, started, (lambda: None) if pipe is not None else lambda: ready(started.endpoints))


if __name__ == "__main__":
    raise SystemExit(main())
