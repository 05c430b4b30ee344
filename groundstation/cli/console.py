"""Opens the screen: starts a station, or attaches to one, checks the terminal before that, and runs the UI."""

from __future__ import annotations

import argparse
import errno
import os
import shutil
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from platformdirs import user_log_path

from groundstation.cli.local.runner import UsageError, load_settings, report_mistakes
from groundstation.cli.options import REPLAY_SETTINGS, build_parser, option_words
from groundstation.cli.terminal import needs_ascii
from groundstation.cli.unknown_options import describe_unknown
from groundstation.client import StationClient
from groundstation.config.effective import Effective, build_keymap, resolve_endpoints
from groundstation.config.settings import Settings, ThemeName
from groundstation.gamepad.child import GamepadChild, missing_package
from groundstation.gamepad.tab_stick import TabStick
from groundstation.host_process import HostProcess
from groundstation.input.pad_mapping import OFF, add_buttons, build_mapping
from groundstation.input.style import Style
from groundstation.recent.recent_file import RecentFile
from groundstation.recording.options import RecordOptions
from groundstation.speech.programs import find_program, missing_program
from groundstation.ui.terminal.frozen_terminal import find_proxy, style_refusal
from groundstation.ui.terminal.tmux import TmuxSession
from link.runtime.whole_file import PRIVATE

if TYPE_CHECKING:
    from groundstation.ui.app.without_looking import Aids
    from groundstation.ui.learn.lesson_dock import LessonDock  # the UI is imported while the station starts
    from groundstation.ui.look.appearance import Look
import contextlib

from link.runtime import stdio

MIN_TERMINAL_SIZE = (40, 10)
"""Columns and rows below which not even the message fits that the terminal is too small."""


def run(arguments: Sequence[str], process: HostProcess | None) -> int:
    """Run `mavhelm` without a verb; return the exit code. `process` waits for the arguments of a station."""
    parser, names = build_parser()
    options, unknown = parser.parse_known_args(parser.reject_empty(arguments))
    if unknown:
        parser.error(describe_unknown(unknown, names))
    word = arguments[0] if arguments else ""
    return report_mistakes(lambda: _run(options, names, process), word)


def _find_proxy_in_tmux() -> str:
    session = TmuxSession.from_environment()
    session.ask()
    return session.proxy


def _run(options: argparse.Namespace, names: Sequence[str], process: HostProcess | None) -> int:
    effective = load_settings(options)
    settings = effective.settings
    if settings.style != Style.HOLD and (why := style_refusal(settings.style, find_proxy() or _find_proxy_in_tmux())):
        raise UsageError(f"--style {why}")
    if options.camera and not options.sitl:
        raise UsageError("--camera is for --sitl; the camera of a rover is in its rover.toml: docs/camera.md")
    endpoints = _endpoints(options, effective, names)

    def start(log_file: Path | None) -> StationClient:
        return StationClient.start(
            endpoints,
            system=settings.system,
            style=settings.style,
            speed=settings.speed,
            take_off=settings.take_off,
            sitl=options.sitl,
            simulators=[("--camera",)] if options.camera else [],
            log_file=log_file,
            dialect=settings.dialect_path,
            sign_key=settings.sign_key,
            require_signing=settings.require_signing,
            param_docs=docs_file(settings.param_docs),
            record=record_options(settings, log_file),
            terminal=terminal_path(),
            keep=settings.keep,
            process=process,
            meanwhile=import_screen,
        )

    return open_screen(settings, start, "drive" if endpoints or options.sitl else "connect", endpoints)


def open_screen(
    settings: Settings,
    connect: Callable[[Path | None], StationClient],
    first: str,
    opened: Sequence[str] = (),
    *,
    stick: TabStick | None = None,
    lesson: LessonDock | None = None,
) -> int:
    """Run the UI to its end with a station; return the exit code. `connect` gets the log file.

    `first` is the screen that is shown at first; `opened` are the endpoints to remember. `stick` takes the place of a
    gamepad. `lesson` is shown beside the screens.

    Raises UsageError, KeymapError, StationError.
    """
    keymap = build_keymap(settings)
    check_terminal()
    if settings.speak and find_program() is None:
        raise UsageError(missing_program())
    gamepad = stick or _gamepad(settings)
    if gamepad is not None:
        keymap = add_buttons(keymap, gamepad.mapping)
    log_file = find_log_file(settings.log_file)
    folder = _folder(settings.folder, log_file)
    client = connect(log_file)
    quits = False
    try:
        from groundstation.ui.app.run import run as run_ui

        remember(opened)
        code = run_ui(
            client,
            keymap=keymap,
            log_file=log_file,
            folder=folder,
            look=_look(settings),
            first=first,
            first_request=client.first_request,
            dialect=settings.dialect_path,
            replay_options=option_words(settings, REPLAY_SETTINGS),
            gamepad=gamepad,
            lesson=lesson,
            aids=_aids(settings),
        )
        quits = code == 0
        return code
    finally:
        if gamepad is not None:
            gamepad.stop()
        client.close(quits=quits)
        remember(opened, client.vehicle_name)
        report_session(client.left_armed, client.logs)


def _gamepad(settings: Settings) -> GamepadChild | None:
    """Return the gamepad to start. Raises UsageError without the packages that it needs."""
    if settings.gamepad == OFF:
        return None
    if problem := missing_package():
        raise UsageError(problem)
    return GamepadChild(build_mapping(settings.pad), settings.gamepad)


def _look(settings: Settings) -> Look:
    from groundstation.ui.look.appearance import Look

    return Look(
        theme=settings.theme or ThemeName.DARK,
        ascii=needs_ascii() if settings.ascii is None else settings.ascii,
        reduce_motion=settings.reduce_motion,
    )


def _aids(settings: Settings) -> Aids:
    from groundstation.ui.app.without_looking import Aids

    return Aids(settings.speak, settings.bell, settings.cursor)


def remember(endpoints: Sequence[str], vehicle: str = "") -> None:
    """Note the endpoints as used; `vehicle` was heard there."""
    file = RecentFile()
    file.update(lambda recent: recent.add_all(endpoints, time.time(), vehicle))
    if file.warning:
        print(f"mavhelm: {file.warning}", file=sys.stderr)


def import_screen() -> None:
    """Import the screen, which takes 0.2 s: after the arguments are checked, and while the station starts."""
    import groundstation.ui.app.run  # noqa: F401


def _endpoints(options: argparse.Namespace, effective: Effective, names: Sequence[str]) -> list[str]:
    """Return what to open. Without an endpoint on the command line or in the settings, the Connect screen comes first.

    A simulator alone opens nothing that the command line does not name.
    """
    settings = effective.settings
    if not options.endpoints and (options.sitl or "open" not in effective.sources):
        return []
    for text in options.endpoints:
        if ":" in text or text in settings.endpoints:
            continue
        if f"--{text}" in names:
            raise UsageError(f"{text!r} is not an endpoint: did you mean --{text}?")
        from groundstation.cli.verb_help import EVERY_VERB  # takes 12 ms, which the start with an endpoint does without

        if text in EVERY_VERB:
            raise UsageError(f"{text!r} is a verb: write it first, and the endpoint behind -e (mavhelm {text} --help)")
    return resolve_endpoints(settings.open, settings)


def check_terminal() -> None:
    """Raise UsageError where no screen can be shown."""
    if os.environ.get("TERM") == "dumb":
        raise UsageError("TERM=dumb cannot place text on the screen: run mavhelm in a terminal such as xterm or tmux")
    for name, stream in (("input", sys.stdin), ("output", sys.stdout)):
        if stream is None or not stream.isatty():
            raise UsageError(f"standard {name} is not a terminal: run mavhelm in one, without a pipe or redirection")
    columns, rows = shutil.get_terminal_size()
    least_columns, least_rows = MIN_TERMINAL_SIZE
    if columns < least_columns or rows < least_rows:
        raise UsageError(
            f"the terminal is {columns}x{rows}: make it at least {least_columns}x{least_rows}, better 80x24"
        )


def terminal_path() -> str | None:
    """Return the path of the terminal; None where it has none, as in some containers."""
    try:
        return os.ttyname(sys.stdout.fileno())
    except OSError:
        return None


def _folder(requested: str | None, log_file: Path | None) -> Path:
    """Return the folder in which screens save files. Raises UsageError if the requested one cannot be made."""
    if requested is None:
        return log_file.parent if log_file else Path.home()
    return _make_folder("folder", requested)


def record_options(settings: Settings, log_file: Path | None) -> RecordOptions | None:
    """Return how to record: by default beside what screens save. Raises UsageError if the folder cannot be made."""
    if not settings.record:
        return None
    folder = _folder(settings.folder, log_file)
    if settings.record_folder is not None:
        folder = _make_folder("--record-to", settings.record_folder)
    video = settings.record_video, settings.record_video_folder_size
    return RecordOptions(folder, settings.record_file_size, settings.record_folder_size, *video)


def _make_folder(what: str, requested: str) -> Path:
    path = Path(requested).expanduser().absolute()
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"{what} {path}: {error.strerror}") from error
    return path


def find_log_file(requested: str | None) -> Path | None:
    """Return the requested log file, or the default one, or None if the default cannot be written.

    Raises UsageError if the requested file cannot be written.
    """
    path = Path(requested).expanduser() if requested else user_log_path("mavhelm") / "groundstation.log"
    try:
        if requested is None:
            path.parent.mkdir(parents=True, exist_ok=True)
        if path.is_fifo():
            raise OSError(errno.EINVAL, "a pipe; name a file")  # opening it would block until a reader comes
        with open(path, "a", encoding="utf-8", opener=lambda name, flags: os.open(name, flags, PRIVATE)):
            return path.absolute()
    except OSError as error:
        if requested is None:
            return None
        raise UsageError(f"log file {path}: {error.strerror}") from error


def docs_file(requested: str | None) -> Path | None:
    """Return the file with texts of parameters. Raises UsageError if it cannot be read."""
    if requested is None:
        return None
    path = Path(requested).expanduser()
    try:
        with path.open("rb"):
            return path.absolute()
    except OSError as error:
        raise UsageError(f"--param-docs {path}: {error.strerror}") from error


def report_session(armed: Sequence[str], logs: Sequence[str]) -> None:
    """Print what is left armed, and the logs of the session; the terminal may be closed."""
    with contextlib.suppress(OSError):
        for line in (*armed, *map(_describe_log, logs)):
            sys.stderr.write(f"mavhelm: {stdio.escape(line)}\n")
            sys.stderr.flush()


def _describe_log(name: str) -> str:
    """Return where a log is, how long it is, and for how long a vehicle drove in it."""
    from groundstation.ui.base.local_files import short_path
    from groundstation.ui.files.log_summary import read_summary
    from groundstation.ui.replay.model import duration_text

    path = Path(name)
    found = read_summary(path)
    if found is None or found.length is None:
        return f"log: {short_path(path)}"
    driven = (
        f", driven {duration_text(found.driven)}" if found.driven else ", nothing was armed" if found.armed == 0 else ""
    )
    return f"log: {short_path(path)} ({duration_text(found.length)}{driven})"
