"""Starts a station: its keys, its watchdog, its links. Imports nothing else, because the screen waits for it."""

from __future__ import annotations

import argparse
import socket
import time
from collections.abc import Sequence

import msgspec

from dialects.enums import Severity
from dialects.extra.errors import DialectError
from dialects.extra.notes import Note
from dialects.extra.option import use_dialect
from groundstation.connect.signing import SigningError, StationSigning
from groundstation.host.options import log_to
from groundstation.sitl.sitl import SimulatorControl, free_port
from groundstation.station.component import COMPONENT
from groundstation.vehicles.state.places import PLACES
from groundstation.watchdog.feed import WatchdogFeed
from link.endpoint import EndpointError, Side, parse_endpoint
from link.links import open_links
from link.protocol.sent_frames import SentFrames
from link.transport.transport import Link, LinkError


class StartError(RuntimeError):
    """The station cannot start; the message is one line for the user."""


class StartedStation(msgspec.Struct, frozen=True):
    """What a station runs with."""

    endpoints: tuple[str, ...]
    links: list[Link]
    watchdog: WatchdogFeed
    sent: SentFrames
    signing: StationSigning
    simulators: SimulatorControl
    notes: Sequence[Note]
    """For the log: on the dialect file, and on a simulator that did not start."""


def start(options: argparse.Namespace, pipe: socket.socket | None, watchdog: socket.socket | None) -> StartedStation:
    """Start the watchdog and the simulator, and open the links. Raises StartError.

    `pipe` and `watchdog` lead to the screen; the second is for the watchdog alone.
    """
    try:
        signing = StationSigning(time.monotonic(), key=options.sign_key, required=options.require_signing)
    except SigningError as error:
        raise StartError(str(error)) from error
    feed = _start_watchdog(options, pipe, watchdog, signing)  # before the links: it inherits none
    endpoints = list(options.endpoints)
    try:
        if options.sitl and not any(parse_endpoint(text).scheme == "udpin" for text in endpoints):
            endpoints.append(f"udpin:127.0.0.1:{free_port()}")  # for the simulator
        log_to(options.log_file)
        notes = use_dialect(options.dialect)
        sent = SentFrames()
        side = Side.GROUND_STATION
        links = open_links(endpoints, system=options.system, component=COMPONENT, sent=sent, places=PLACES, side=side)
        known = tuple(parse_endpoint(text).text for text in endpoints)
    except (DialectError, EndpointError, LinkError, OSError) as error:
        feed.close()
        from groundstation.station_socket.about import ATTACH, explain_taken

        raise StartError(explain_taken(_one_line(error), ATTACH)) from error
    simulators = SimulatorControl()
    rovers = [words.split() for words in options.simulator]
    problem = simulators.start([link.endpoint for link in links], options=rovers) if options.sitl else None
    if problem is not None:
        notes = (*notes, Note(problem, Severity.WARNING))
    return StartedStation(known, links, feed, sent, signing, simulators, notes)


def _start_watchdog(
    options: argparse.Namespace, pipe: socket.socket | None, watchdog: socket.socket | None, signing: StationSigning
) -> WatchdogFeed:
    """Start the watchdog, with a socket to the screen if there is one."""
    ids, keys = (options.system, COMPONENT), (signing.link_signing.signing, signing.reload)
    if watchdog is not None:
        with watchdog:
            return WatchdogFeed.start(watchdog, options.terminal, ids, *keys, of_station=pipe)
    return WatchdogFeed.start(None, None, ids, *keys)


def _one_line(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    return str(error)
