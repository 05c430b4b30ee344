"""The station process: opens the links and runs the station. It has no terminal."""

from __future__ import annotations

import argparse
import contextlib
import gc
import logging
import secrets
import socket
import time
from collections.abc import Callable, Sequence

from dialects.enums import Severity
from dialects.extra.errors import DialectError
from dialects.extra.option import Note, use_dialect
from groundstation.connect.signing import SigningError, StationSigning
from groundstation.disk.texts_folder import load_texts
from groundstation.host.options import log_to, open_screen_pipe, station_parser
from groundstation.host.screens import Lifetime
from groundstation.host.station_host import StationHost
from groundstation.input.style import Style
from groundstation.ipc import StationReady, encode
from groundstation.recording.log_folder import MEGABYTE, LogFolder, LogLimits
from groundstation.recording.station_recording import StationRecording
from groundstation.sitl.sitl import free_port
from groundstation.station.station import COMPONENT, Station
from groundstation.station_socket.hello import StationFailed
from groundstation.vehicles.fleet import PLACES
from groundstation.verbs.line.loader import LineLoader
from groundstation.watchdog.feed import WatchdogFeed
from link.endpoint import EndpointError, Side, parse_endpoint
from link.protocol.sent_frames import SentFrames
from link.runner import open_links
from link.runtime.event_loop import run_loop
from link.transport.transport import Link, LinkError

log = logging.getLogger(__name__)


class StartError(RuntimeError):
    """The station cannot start; the message is one line for the user."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a station for the screen at the other end of --fd. Returns 2 if it could not start, after sending why."""
    options = station_parser().parse_args(arguments)
    pipe = open_screen_pipe(options.fd)
    try:
        return run_station(options, pipe, lambda endpoints: _tell(pipe, StationReady(endpoints)))
    except StartError as error:
        _tell(pipe, StationFailed(str(error)))
        return 2


def run_station(
    options: argparse.Namespace, pipe: socket.socket | None, ready: Callable[[tuple[str, ...]], None]
) -> int:
    """Run a station to its end; return the exit code. `ready` is called with its endpoints once they are open.

    Without a pipe it has no screen, and SIGINT ends it like SIGTERM. Raises StartError.
    """
    try:
        signing = StationSigning(time.monotonic(), key=options.sign_key, required=options.require_signing)
    except SigningError as error:
        raise StartError(str(error)) from error
    watchdog = _start_watchdog(options, pipe, signing)  # before the links: it inherits none
    endpoints = [*options.endpoints, *([f"udpin:127.0.0.1:{free_port()}"] if options.sitl else [])]
    try:
        log_to(options.log_file)
        notes = use_dialect(options.dialect)
        sent = SentFrames()
        side = Side.GROUND_STATION
        links = open_links(endpoints, system=options.system, component=COMPONENT, sent=sent, places=PLACES, side=side)
        known = tuple(parse_endpoint(text).text for text in endpoints)
    except (DialectError, EndpointError, LinkError, OSError) as error:
        watchdog.close()
        raise StartError(_one_line(error)) from error
    ready(known)
    return _run(options, known, links, pipe, watchdog, sent, notes, signing)


def _tell(pipe: socket.socket, message: StationReady | StationFailed) -> None:
    with contextlib.suppress(OSError):  # the screen has exited; the end of the pipe ends the station
        pipe.send(encode(message))


def _start_watchdog(options: argparse.Namespace, pipe: socket.socket | None, signing: StationSigning) -> WatchdogFeed:
    """Start the watchdog; without a screen its end of the pipe leads nowhere."""
    ids, keys = (options.system, COMPONENT), (signing.keeper.signing, signing.reload)
    if pipe is not None:
        return WatchdogFeed.start(pipe, options.terminal, ids, *keys)
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with ours, theirs:
        return WatchdogFeed.start(theirs, None, ids, *keys)


def _run(
    options: argparse.Namespace,
    endpoints: tuple[str, ...],
    links: list[Link],
    pipe: socket.socket | None,
    watchdog: WatchdogFeed,
    sent: SentFrames,
    notes: Sequence[Note],
    signing: StationSigning,
) -> int:
    started = time.monotonic()  # the loop's clock
    session = secrets.randbits(32)
    texts = load_texts(options.param_docs)
    station = Station(
        endpoints,
        system=options.system,
        style=Style(options.style),
        speed=options.speed,
        session=session,
        texts=texts,
        now=started,
    )
    ids, lifetime = (options.system, COMPONENT), _lifetime(options)
    screen = f"screen on {options.terminal.removeprefix('/dev/')}" if options.terminal else "first screen"
    recording = _open_recording(options, station, sent)
    host = StationHost(
        station,
        links,
        pipe,
        watchdog,
        ids=ids,
        sent=sent,
        recording=recording,
        lifetime=lifetime,
        screen=screen,
        signing=signing,
    )
    host.handlers.append(LineLoader(station, ids, host.flush).handle)
    for note in notes:
        host.add_to_log(started, note.text, note.severity)
    for problem in texts.problems:
        host.add_to_log(started, problem, Severity.WARNING)
    if options.sitl:
        host.connect.start_simulator(started)
    gc.collect()
    gc.freeze()  # imported objects are never freed; without freezing them a full collection delays demands by 30 ms
    try:
        return run_loop(host.run())
    except Exception:
        log.exception("station crashed")
        return 1


def _open_recording(options: argparse.Namespace, station: Station, sent: SentFrames) -> StationRecording | None:
    if options.record_to is None:
        return None
    limits = LogLimits(options.record_file_size * MEGABYTE, options.record_folder_size * MEGABYTE)
    return StationRecording(station, LogFolder(options.record_to, limits), (options.system, COMPONENT), sent)


def _lifetime(options: argparse.Namespace) -> Lifetime:
    if options.fd is None:
        return Lifetime.SIGNAL
    return Lifetime.QUIT if options.keep else Lifetime.SCREEN


def _one_line(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return str(error)


if __name__ == "__main__":
    raise SystemExit(main())
