"""Command line of `mavhelm bridge router`: runs a Zenoh router, with certificates and roles from fleet.toml."""

from __future__ import annotations

import argparse
import json
import logging
import os
import signal
import socket
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from link.bridge.fleet.access import build_access
from link.bridge.fleet.fleet_file import (
    AUTHORITY,
    ROUTER,
    ROUTER_KEY,
    ROUTER_NAME,
    FleetFile,
    locator_problem,
    read_fleet_file,
)
from link.bridge.fleet.members import read_encoded
from link.bridge.fleet.self_probe import SelfProbe, raise_descriptor_limit
from link.fleet.config import SETTINGS, apply_settings, load_zenoh
from link.fleet.router_session import direct
from link.fleet.validity import warning_of
from link.runtime import stdio
from link.runtime.command_line import CommandLineParser
from link.toml.file import TomlError
from link.transport.transport import LinkError

log = logging.getLogger(__name__)

ROUTER_SETTINGS: dict[str, Any] = {
    "mode": "router",
    "connect/timeout_ms": -1,  # the other router may start later, or again
    "connect/exit_on_failure": False,
    "connect/retry": {"period_init_ms": 200, "period_max_ms": 500, "period_increase_factor": 1.5},  # Zenoh's go to 4 s
    "transport/unicast/max_sessions": 10_000,  # Zenoh's own limit is 1000
    "transport/unicast/accept_timeout": 2_000,  # ms from TLS to a session; Zenoh's own are 10 s
    "transport/unicast/accept_pending": 1_000,  # after a restart all come at once
    "transport/link/protocols": ["tls", "quic"],
}
NOT_ANSWERED = 1
"""Exit code of a router that lets nobody new in (self_probe.py)."""
ENOUGH_DESCRIPTORS = 4096
"""Below that a few strangers with 20 connections each fill them."""
SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
HELP = """\
FILE is made by `mavhelm bridge fleet new`. Whoever it does not name is refused, whatever its certificate.
A restart takes a second; vehicles and ground stations reconnect by themselves, and rovers stop meanwhile.

It asks its own port every 10 s, and ends when three probes in a row are not answered: let a supervisor start it again.

exit codes: 0 stopped by a signal (SIGTERM, Ctrl-C, SIGHUP), 1 its port let nobody in, 2 usage error.
"""


def run(arguments: Sequence[str]) -> int:
    """Run until a signal; return the exit code."""
    parser = build_parser()
    options = parser.parse_args(parser.reject_empty(arguments))
    stdio.log_plainly(logging.StreamHandler(), logging.INFO, "bridge router: %(message)s")
    try:
        _run(read_fleet_file(options.file), options.file.parent, _read_links(options.link))
    except (TomlError, LinkError) as error:
        parser.exit(2, f"{parser.prog}: {error}\n")
    except OSError as error:
        parser.exit(2, f"{parser.prog}: {error.filename}: {error.strerror}\n")
    return 0


def _run(fleet: FleetFile, folder: Path, links: Sequence[str]) -> None:
    descriptors = raise_descriptor_limit()
    before = signal.pthread_sigmask(
        signal.SIG_BLOCK, SIGNALS
    )  # Zenoh's threads inherit it, so that sigwait() gets them
    try:
        session = _open(fleet, folder, links)
        watching = session.info.declare_link_events_listener(direct(_log_link(fleet)), history=True)
        members = f"{len(fleet.vehicles)} vehicles, {len(fleet.operators)} operators"
        log.info("ready, fleet %s, %s, %s", fleet.fleet, " + ".join(fleet.listen), members)
        if descriptors < ENOUGH_DESCRIPTORS:
            log.warning("may open %d files only: set LimitNOFILE in its unit (docs/fleet.md)", descriptors)
        for warning in _end_warnings(folder):
            log.warning("%s", warning)
        probe = SelfProbe(fleet.listen, folder, _end_process)
        probe.start()
        signal.sigwait(SIGNALS)
        probe.close()
        watching.undeclare()
        session.close()
        log.info("stopped")
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _end_warnings(folder: Path) -> Iterator[str]:
    """Yield a line for each certificate of the router that ends soon."""
    for whose, file, remedy in (
        ("the router", ROUTER, f"mavhelm bridge fleet renew {ROUTER_NAME}, and restart it"),
        ("the fleet's authority", AUTHORITY, "make the fleet anew (docs/fleet.md)"),
    ):
        if warning := warning_of(whose, (folder / file).read_bytes(), time.time(), remedy):
            yield warning


def _end_process(why: str) -> None:
    """End at once, whatever Zenoh does: its threads may wait for a descriptor for ever."""
    log.error("%s; ending, so that it is started again: limit connections as docs/fleet.md says", why)
    logging.shutdown()
    os._exit(NOT_ANSWERED)


def _open(fleet: FleetFile, folder: Path, links: Sequence[str]) -> Any:
    zenoh = load_zenoh()
    config = zenoh.Config()
    tls = {
        "root_ca_certificate_base64": read_encoded(folder / AUTHORITY),
        "listen_certificate_base64": read_encoded(folder / ROUTER),
        "listen_private_key_base64": read_encoded(folder / ROUTER_KEY),
        "connect_certificate_base64": read_encoded(folder / ROUTER),
        "connect_private_key_base64": read_encoded(folder / ROUTER_KEY),
        "enable_mtls": True,
    }
    places = {"listen/endpoints": fleet.listen, "connect/endpoints": list(links)}
    apply_settings(config, SETTINGS | ROUTER_SETTINGS | places)
    apply_settings(config, {f"transport/link/tls/{key}": value for key, value in tls.items()})
    config.insert_json5("access_control", json.dumps(build_access(fleet)))
    try:
        return zenoh.open(config)
    except zenoh.ZError as error:
        raise LinkError(_explain(fleet, str(error))) from None


def _read_links(locators: Sequence[str]) -> Sequence[str]:
    """Return the other routers. Raises LinkError."""
    for each in locators:
        if problem := locator_problem(each):
            raise LinkError(f"--link: {problem}")
    return locators


def _explain(fleet: FleetFile, error: str) -> str:
    """Return why the router did not start, in one line."""
    where = ", ".join(fleet.listen)
    if "in use" in error or not all(map(_is_free, fleet.listen)):
        return f"{where}: the port is in use; stop the other program (`ss -lnp` lists it) or choose another one"
    return f"{where}: {' '.join(error.split(' at /')[0].split())[:200]}"


def _is_free(locator: str) -> bool:
    kind = socket.SOCK_DGRAM if locator.startswith("quic/") else socket.SOCK_STREAM
    host, _, port = locator.partition("/")[2].rpartition(":")
    try:
        family, _, _, _, address = socket.getaddrinfo(host.strip("[]"), int(port), type=kind)[0]
        with socket.socket(family, kind) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
    except OSError:
        return False
    return True


def _log_link(fleet: FleetFile) -> Any:
    """Return a callback that logs who connects and disconnects, by the names of fleet.toml."""
    owners = {ROUTER_NAME: "router"}
    owners |= {each.certificate: f"vehicle {name}" for name, each in fleet.vehicles.items()}
    owners |= {each.certificate: f"operator {name} ({each.role})" for name, each in fleet.operators.items()}
    second = load_zenoh().Reliability.BEST_EFFORT

    def note(event: Any) -> None:
        if event.link.reliability == second:  # a session over QUIC has two links; Zenoh tells the end of both
            return
        certificate = event.link.auth_identifier
        who = owners.get(certificate, f"{certificate}, who is not in the file and may do nothing,")
        log.info("%s %s %s", who, "from" if str(event.kind).endswith("PUT") else "has gone from", event.link.dst)

    return note


def build_parser() -> CommandLineParser:
    """Return the parser of the command line."""
    parser = CommandLineParser(
        prog="mavhelm bridge router",
        description="Runs the router of a fleet: vehicles and ground stations meet there, each with its certificate.",
        epilog=HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("file", metavar="FILE", type=Path, help="fleet.toml")
    parser.add_argument(
        "--link",
        metavar="LOCATOR",
        action="append",
        default=[],
        help="another router of the same fleet, as tls/b.example.org:7447; may be given again",
    )
    return parser
