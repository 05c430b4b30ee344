"""The station and replay processes: command line, log file, and the socket to the screen."""

from __future__ import annotations

import argparse
import logging
import logging.handlers
import signal
import socket
from pathlib import Path

from groundstation.host_process import STATION, read_arguments
from groundstation.input.style import Style
from groundstation.intents.vehicle import TAKE_OFF_ALTITUDE
from groundstation.station_socket.connect import SOCKET_BUFFER
from link.runtime import stdio
from link.runtime.local_socket import take_over

LOG_SIZE = 1 << 20
LOG_FORMAT = "%(asctime)s %(levelname)s %(name)s: %(message)s"


def open_screen_pipes(
    parser: argparse.ArgumentParser,
) -> tuple[socket.socket, socket.socket | None, argparse.Namespace | None]:
    """Return the sockets of --fd and --watchdog-fd to the screen's process, and the arguments; None: it has ended.

    The arguments come through the first. The keys of the terminal are left to the screen from now on.
    """
    for number in (signal.SIGINT, signal.SIGTSTP):
        signal.signal(number, signal.SIG_IGN)
    given = argparse.ArgumentParser(prog=parser.prog, description="Started by `mavhelm`, not by hand.")
    given.add_argument("--fd", type=int, required=True, help="our end of the pipe, which brings all other arguments")
    given.add_argument("--watchdog-fd", type=int, help="the watchdog's end of its own pipe to the screen")
    descriptors = given.parse_args()
    pipe = take_over(descriptors.fd)
    watchdog = None if descriptors.watchdog_fd is None else take_over(descriptors.watchdog_fd)
    pipe.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SOCKET_BUFFER)
    arguments = read_arguments(pipe)
    pipe.setblocking(False)
    return pipe, watchdog, None if arguments is None else parser.parse_args(arguments)


def log_to(path: Path | None) -> None:
    """Write the log of all libraries to the file, or nowhere."""
    handler: logging.Handler = logging.NullHandler()
    if path is not None:
        handler = logging.handlers.RotatingFileHandler(path, maxBytes=LOG_SIZE, backupCount=1, encoding="utf-8")
    stdio.log_plainly(handler, logging.INFO, LOG_FORMAT)
    logging.captureWarnings(True)


def station_parser() -> argparse.ArgumentParser:
    """Return the parser of the station process."""
    parser = argparse.ArgumentParser(STATION)
    parser.add_argument("--keep", action="store_true", help="go on when the screen is killed or hung up")
    parser.add_argument("--system", type=int, default=255)
    parser.add_argument("--style", choices=list(Style), default=Style.HOLD)
    parser.add_argument("--speed", type=float, default=0.6)
    parser.add_argument("--take-off", type=float, default=TAKE_OFF_ALTITUDE, metavar="METRES")
    parser.add_argument("--sitl", action="store_true")
    parser.add_argument(
        "--simulator",
        action="append",
        default=[],
        metavar="OPTIONS",
        help="with --sitl: one rover with these options, in place of the usual one",
    )
    parser.add_argument("--log-file", type=Path)
    parser.add_argument("--sign-key", metavar="NAME", help="key that signs")
    parser.add_argument("--require-signing", action="store_true", help="ignore everything that is not signed")
    parser.add_argument("--dialect", metavar="FILE.xml")
    parser.add_argument("--param-docs", type=Path, help="file with texts of parameters")
    parser.add_argument("--record-to", type=Path, metavar="FOLDER", help="record the session there")
    parser.add_argument("--record-file-size", type=int, default=100, metavar="MB")
    parser.add_argument("--record-folder-size", type=int, default=2000, metavar="MB")
    parser.add_argument("--record-video-folder-size", type=int, default=2000, metavar="MB", help="0: no pictures")
    parser.add_argument("--terminal", help="path of the screen's terminal, which is reset if the screen is killed")
    parser.add_argument("endpoints", nargs="*")
    return parser
