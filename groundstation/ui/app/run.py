"""Runs the UI in this terminal, from its start to its end."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

from groundstation.input.keymap import Keymap
from groundstation.ui.app.app import ConsoleApp
from groundstation.ui.app.exit import exit_on_signals
from groundstation.ui.app.without_looking import Aids
from groundstation.ui.keys.key_gate import StationConnection
from groundstation.ui.keys.pad_input import PadSource
from groundstation.ui.learn.lesson_dock import LessonDock
from groundstation.ui.look.appearance import PLAIN, Look
from groundstation.ui.terminal.tty_output import redirect_output


def run(
    client: StationConnection,
    *,
    keymap: Keymap,
    folder: Path,
    log_file: Path | None = None,
    look: Look = PLAIN,
    first: str = "drive",
    first_request: int = 1,
    dialect: str | None = None,
    replay_options: Sequence[str] = (),
    gamepad: PadSource | None = None,
    lesson: LessonDock | None = None,
    aids: Aids = Aids(),  # noqa: B008  # frozen
) -> int:
    """Run the UI to its end. Return 0 after a quit, 128 + n after signal n, 1 after an internal error.

    `first` is the id of the screen that is shown at first, `first_request` the number of its first request;
    `replay_options` are for logs that are opened here; `lesson` is shown beside the screens.
    """
    with redirect_output(log_file) as terminal:
        app = ConsoleApp(
            client,
            keymap,
            terminal=terminal,
            folder=folder,
            look=look,
            first=first,
            first_request=first_request,
            dialect=dialect,
            replay_options=replay_options,
            gamepad=gamepad,
            lesson=lesson,
            aids=aids,
        )
        with exit_on_signals(app.end_threadsafe, terminal):
            # No mouse events for widgets: mouse.py captures the mouse and discards its reports.
            code = app.run(mouse=False)
    if code is None:
        sys.stderr.write(f"mavhelm: internal error: {log_file or 'run with --log-file: the log'} has the details\n")
        return 1
    return code
