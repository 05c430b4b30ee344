"""Runs a station that has started: builds its parts and runs its loop."""

from __future__ import annotations

import argparse
import logging
import secrets
import socket
import time
from collections.abc import Callable

from dialects.enums import Severity
from groundstation.disk.texts_folder import load_texts
from groundstation.host.screens import Lifetime
from groundstation.host.station_host import StationHost
from groundstation.host.station_start import StartedStation
from groundstation.input.style import Style
from groundstation.recording.log_folder import MEGABYTE, LogFolder, LogLimits
from groundstation.recording.station_recording import StationRecording
from groundstation.station.component import COMPONENT
from groundstation.station.station import Station
from groundstation.verbs.line.loader import LineLoader
from link.protocol.sent_frames import SentFrames
from link.runtime import startup_gc
from link.runtime.event_loop import run_loop

log = logging.getLogger(__name__)


def run(
    options: argparse.Namespace, pipe: socket.socket | None, started: StartedStation, listens: Callable[[], None]
) -> int:
    """Run the station to its end; return the exit code. `listens` is called once programs can attach to it."""
    now = time.monotonic()  # the loop's clock
    texts = load_texts(options.param_docs)
    station = Station(
        started.endpoints,
        system=options.system,
        style=Style(options.style),
        speed=options.speed,
        take_off=options.take_off,
        session=secrets.randbits(32),
        texts=texts,
        now=now,
    )
    ids = (options.system, COMPONENT)
    host = StationHost(
        station,
        started.links,
        pipe,
        started.watchdog,
        ids=ids,
        sent=started.sent,
        recording=_open_recording(options, station, started.sent),
        lifetime=_lifetime(options, pipe),
        screen=f"screen on {options.terminal.removeprefix('/dev/')}" if options.terminal else "first screen",
        signing=started.signing,
        simulators=started.simulators,
        video_limit=options.record_video_folder_size,
    )
    LineLoader(station, host.flush)
    for note in started.notes:
        host.add_to_log(now, note.text, note.severity)
    for problem in texts.problems:
        host.add_to_log(now, problem, Severity.WARNING)
    startup_gc.resume()
    try:
        return run_loop(host.run(listens))
    except Exception:
        log.exception("station crashed")
        return 1


def _open_recording(options: argparse.Namespace, station: Station, sent: SentFrames) -> StationRecording | None:
    if options.record_to is None:
        return None
    limits = LogLimits(options.record_file_size * MEGABYTE, options.record_folder_size * MEGABYTE)
    return StationRecording(station, LogFolder(options.record_to, limits), (options.system, COMPONENT), sent)


def _lifetime(options: argparse.Namespace, pipe: socket.socket | None) -> Lifetime:
    if pipe is None:
        return Lifetime.SIGNAL
    return Lifetime.QUIT if options.keep else Lifetime.SCREEN
