"""Command line of the ground station: checks the arguments before the screen opens, then runs the UI."""

from __future__ import annotations

import argparse
import contextlib
import errno
import os
import shutil
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from platformdirs import user_log_path

from groundstation.cli.mavproxy_words import describe_action, describe_word
from groundstation.cli.options import build_parser, given_settings
from groundstation.cli.terminal import needs_ascii
from groundstation.cli.unknown_options import describe_unknown
from groundstation.cli.verb_help import LOCAL_HELP, RESERVED, VERB_HELP
from groundstation.client import StationClient, StationError
from groundstation.config.config_file import ConfigError
from groundstation.config.effective import Effective, build_keymap, load_config, merge, resolve_endpoints
from groundstation.config.settings import Settings, ThemeName
from groundstation.input.keymap import KeymapError
from groundstation.recent.recent_file import RecentFile
from link.endpoint import EndpointError
from link.runtime import stdio

if TYPE_CHECKING:
    from groundstation.ui.appearance import Look  # the UI is imported while the station starts

MIN_TERMINAL_SIZE = (40, 10)
"""Columns and rows below which not even the message fits that the terminal is too small."""


class UsageError(Exception):
    """A mistake on the command line; the message is one line for the user."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the ground station. Returns 0 after a session, 2 for wrong arguments, 1 when the station crashed.

    A verb returns a code of groundstation/verbs/exit_codes.py.
    """
    stdio.ensure_open()
    arguments = sys.argv[1:] if arguments is None else arguments
    verb = arguments[0] if arguments else ""
    if hint := describe_action(arguments):
        print(f"groundstation: {hint}", file=sys.stderr)
        return 2
    if verb in VERB_HELP:
        from groundstation.verbs.main import run as run_verb  # loads the dialect, which the screen does without

        return run_verb(arguments)
    if verb in LOCAL_HELP:
        return _run_local(verb, arguments[1:])
    parser, names = build_parser()
    options, unknown = parser.parse_known_args(parser.reject_empty(arguments))
    if unknown:
        parser.error(describe_unknown(unknown, names))
    try:
        return _run(options, names)
    except ConfigError as error:
        print(*(f"groundstation: {problem}" for problem in error.problems), sep="\n", file=sys.stderr)
    except (UsageError, EndpointError, KeymapError, StationError) as error:
        is_word = isinstance(error, EndpointError) and repr(verb) in str(error)
        hint = describe_word(verb, RESERVED) if is_word else None
        print(f"groundstation: {hint or error}", file=sys.stderr)
    return 2


def _run_local(verb: str, arguments: Sequence[str]) -> int:
    """Run a verb without a vehicle."""
    if verb == "config":
        from groundstation.cli.config_verb import run as run_config

        return run_config(arguments)
    if verb == "keys":
        from groundstation.cli.keys_verb import run as run_keys  # loads a part of the screen

        return run_keys(arguments)
    from groundstation.verbs.main import run_completion

    return run_completion(arguments, {**VERB_HELP, **LOCAL_HELP})


def _run(options: argparse.Namespace, names: Sequence[str]) -> int:
    config = load_config(options.config, os.environ, RESERVED)
    effective = merge(config, os.environ, given_settings(options))
    settings = effective.settings
    keymap = build_keymap(settings)
    endpoints = _endpoints(options, effective, names)
    _check_terminal()
    log_file = _log_file(settings.log_file)
    folder = _folder(settings.folder, log_file)
    client = StationClient.start(
        endpoints,
        system=settings.system,
        style=settings.style,
        speed=settings.speed,
        sitl=options.sitl,
        log_file=log_file,
        dialect=os.path.expanduser(settings.dialect) if settings.dialect else None,
        param_docs=_docs_file(settings.param_docs),
        terminal=_terminal_path(),
        meanwhile=_import_screen,
    )
    try:
        from groundstation.ui.run import run

        _remember(endpoints)
        first = "drive" if endpoints or options.sitl else "connect"
        return run(client, keymap=keymap, log_file=log_file, folder=folder, look=_look(settings), first=first)
    finally:
        client.close()
        _remember(endpoints, client.vehicle_name)
        report_armed(client.left_armed)


def _look(settings: Settings) -> Look:
    from groundstation.ui.appearance import Look

    return Look(
        theme=settings.theme or ThemeName.DARK,
        ascii=needs_ascii() if settings.ascii is None else settings.ascii,
        reduce_motion=settings.reduce_motion,
    )


def _remember(endpoints: Sequence[str], vehicle: str = "") -> None:
    """Note the endpoints as used; `vehicle` was heard there."""
    file = RecentFile()
    file.update(lambda recent: recent.add_all(endpoints, time.time(), vehicle))
    if file.warning:
        print(f"groundstation: {file.warning}", file=sys.stderr)


def _import_screen() -> None:
    """Import the screen, which takes 0.2 s: after the arguments are checked, and while the station starts."""
    import groundstation.ui.run  # noqa: F401


def report_armed(lines: Sequence[str]) -> None:
    """Print which vehicles are left armed; the terminal may be closed."""
    with contextlib.suppress(OSError):
        for line in lines:
            print(f"groundstation: {line}", file=sys.stderr, flush=True)


def _endpoints(options: argparse.Namespace, effective: Effective, names: Sequence[str]) -> list[str]:
    """Return what to open. Without an endpoint on the command line or in the settings, the Connect screen comes first.

    A simulator alone opens nothing that the command line does not name.
    """
    settings = effective.settings
    if not options.endpoints and (options.sitl or "open" not in effective.sources):
        return []
    for text in options.endpoints:
        if f"--{text}" in names and text not in settings.endpoints:
            raise UsageError(f"{text!r} is not an endpoint: did you mean --{text}?")
    return resolve_endpoints(settings.open, settings)


def _check_terminal() -> None:
    if os.environ.get("TERM") == "dumb":
        raise UsageError(
            "TERM=dumb cannot place text on the screen: run groundstation in a terminal such as xterm or tmux"
        )
    for name, stream in (("input", sys.stdin), ("output", sys.stdout)):
        if stream is None or not stream.isatty():
            raise UsageError(
                f"standard {name} is not a terminal: run groundstation in one, without a pipe or redirection"
            )
    columns, rows = shutil.get_terminal_size()
    least_columns, least_rows = MIN_TERMINAL_SIZE
    if columns < least_columns or rows < least_rows:
        raise UsageError(
            f"the terminal is {columns}x{rows}: make it at least {least_columns}x{least_rows}, better 80x24"
        )


def _terminal_path() -> str | None:
    """Return the path of the terminal; None where it has none, as in some containers."""
    try:
        return os.ttyname(sys.stdout.fileno())
    except OSError:
        return None


def _folder(requested: str | None, log_file: Path | None) -> Path:
    """Return the folder in which screens save files. Raises UsageError if the requested one cannot be made."""
    if requested is None:
        return log_file.parent if log_file else Path.home()
    path = Path(requested).expanduser().absolute()
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"folder {path}: {error.strerror}") from error
    return path


def _log_file(requested: str | None) -> Path | None:
    """Return the requested log file, or the default one, or None if the default cannot be written.

    Raises UsageError if the requested file cannot be written.
    """
    path = Path(requested).expanduser() if requested else user_log_path("mavhelm") / "groundstation.log"
    try:
        if requested is None:
            path.parent.mkdir(parents=True, exist_ok=True)
        if path.is_fifo():
            raise OSError(errno.EINVAL, "a pipe; name a file")  # opening it would block until a reader comes
        with path.open("a", encoding="utf-8"):
            return path.absolute()
    except OSError as error:
        if requested is None:
            return None
        raise UsageError(f"log file {path}: {error.strerror}") from error


def _docs_file(requested: str | None) -> Path | None:
    """Return the file with texts of parameters. Raises UsageError if it cannot be read."""
    if requested is None:
        return None
    path = Path(requested).expanduser()
    try:
        with path.open("rb"):
            return path.absolute()
    except OSError as error:
        raise UsageError(f"--param-docs {path}: {error.strerror}") from error


if __name__ == "__main__":
    raise SystemExit(main())
