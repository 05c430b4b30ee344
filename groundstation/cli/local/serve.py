"""`mavhelm serve`: a station without a screen, for verbs, `mavhelm attach` and browsers of this machine."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from groundstation.cli.console import docs_file, find_log_file, record_options
from groundstation.cli.local.runner import UsageError, load_settings, run_local
from groundstation.cli.options import REPLAY_SETTINGS, add_config, add_port, add_settings, option_words
from groundstation.cli.verb_help import local_examples
from groundstation.client import StationError
from groundstation.config.effective import resolve_endpoints
from groundstation.config.settings import Settings
from groundstation.station_socket.folder import FolderError, make_folder
from groundstation.web.launch import WebLaunch, missing_package
from link.runtime.command_line import CommandLineParser

TAB_SETTINGS = tuple(name for name in REPLAY_SETTINGS if name != "ascii")
"""Settings that the screens of the tabs take over."""

TAB_OPTIONS = ("--no-ascii", "--gamepad=off")
"""Of each tab. A gamepad is at this machine, and the tab may not be."""
WATCH = "--watch"
"""Of the tabs of real vehicles: one that a browser opens again must not drive by itself."""

EPILOG = """\
It drives nothing by itself: without a screen it sends no demand and no heartbeat, so that the failsafes of a vehicle
act as without a ground station. Ctrl-C or SIGTERM ends it, after neutral.

--web prints an address with a token, for browsers of this machine: tabs watch until `g` takes the keys.

exit codes: 0 after its end, 1 if it crashed, 2 for wrong arguments
"""


def build_parser() -> CommandLineParser:
    """Return the parser."""
    parser = CommandLineParser(
        prog="mavhelm serve",
        description="Run a station that verbs and `mavhelm attach` use.",
        epilog=f"{local_examples('serve')}\n\n{EPILOG}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("endpoints", nargs="*", metavar="ENDPOINT|NAME", help="where vehicles are")
    parser.add_argument("--headless", action="store_true", help="without a screen")
    parser.add_argument("--web", action="store_true", help="with screens in browsers of this machine; docs/browser.md")
    add_port(parser)
    parser.add_argument("--sitl", action="store_true", help="start a simulated rover, and end it with the station")
    add_settings(parser)
    add_config(parser)
    return parser


def run(arguments: Sequence[str]) -> int:
    """Run `mavhelm serve`; return the exit code."""
    return run_local(build_parser(), arguments, _serve)


def _serve(options: argparse.Namespace) -> int:
    if not options.headless and not options.web:
        raise UsageError("give --headless or --web; `mavhelm --keep` opens a screen whose station survives it")
    settings = load_settings(options).settings
    endpoints = [] if options.sitl and not options.endpoints else resolve_endpoints(settings.open, settings)
    return serve(settings, endpoints, sitl=options.sitl, port=options.port if options.web else None)


def serve(
    settings: Settings,
    endpoints: Sequence[str],
    *,
    sitl: bool,
    simulators: Sequence[Sequence[str]] = (),
    port: int | None = None,
    tab_options: Sequence[str] = (WATCH,),
) -> int:
    """Run a station to its end; return the exit code. `port`: for browsers, None for none. Raises StationError.

    `simulators`: see StationClient.start(). `tab_options` are of `mavhelm attach` in each tab.
    """
    try:
        make_folder()
    except FolderError as error:  # nothing could use this station
        raise StationError(str(error)) from error
    from groundstation.host.station_process import run_station
    from groundstation.host.station_start import StartError  # loads the dialect, which the screen does without

    launch = None if port is None else _listen(port)
    try:
        if launch is not None:
            words = [*TAB_OPTIONS, *tab_options, *option_words(settings, TAB_SETTINGS)]
            launch.start(["attach", str(os.getpid()), *words])
        given = _station_options(settings, endpoints, sitl=sitl)
        given.simulator = [" ".join(each) for each in simulators]
        return run_station(given, lambda opened: _announce(opened, launch))
    except StartError as error:
        raise StationError(str(error)) from error
    finally:
        if launch is not None:
            launch.stop()


def _listen(port: int) -> WebLaunch:
    """Return the port for browsers. Raises UsageError."""
    if problem := missing_package():
        raise UsageError(problem)
    try:
        return WebLaunch(port)
    except OSError as error:
        raise UsageError(f"--port {port}: {os.strerror(error.errno or 0)}; choose another one") from error


def _station_options(settings: Settings, endpoints: Sequence[str], *, sitl: bool) -> argparse.Namespace:
    log_file = find_log_file(settings.log_file)
    record = record_options(settings, log_file)
    return argparse.Namespace(
        keep=False,
        terminal=None,
        endpoints=endpoints,
        sitl=sitl,
        simulator=[],
        system=settings.system,
        style=settings.style,
        speed=settings.speed,
        take_off=settings.take_off,
        log_file=log_file,
        dialect=settings.dialect_path,
        sign_key=settings.sign_key,
        require_signing=settings.require_signing,
        param_docs=docs_file(settings.param_docs),
        record_to=record.folder if record else None,
        record_file_size=settings.record_file_size,
        record_folder_size=settings.record_folder_size,
        record_video_folder_size=settings.record_video_folder_size if settings.record_video else 0,
    )


def _announce(endpoints: tuple[str, ...], launch: WebLaunch | None) -> None:
    where = " ".join(endpoints) or "no link yet"
    print(f"station {os.getpid()} on {where}; `mavhelm attach` opens a screen", file=sys.stderr, flush=True)
    if launch is not None:
        print(f"in a browser on this machine: {launch.url}", file=sys.stderr, flush=True)
