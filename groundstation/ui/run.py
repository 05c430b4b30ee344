"""Runs the UI in this terminal, from its start to its end."""

from __future__ import annotations

import sys
from pathlib import Path

from groundstation.input.keymap import Keymap
from groundstation.ui.app import ConsoleApp
from groundstation.ui.appearance import PLAIN, Look
from groundstation.ui.exit import exit_on_signals
from groundstation.ui.key_gate import StationConnection
from groundstation.ui.tty_output import redirect_output


def run(
    client: StationConnection,
    *,
    keymap: Keymap,
    folder: Path,
    log_file: Path | None = None,
    look: Look = PLAIN,
    first: str = "drive",
) -> int:
    """Run the UI to its end. Return 0 after a quit, 128 + n after signal n, 1 after an internal error.

    `first` is the id of the screen that is shown at first.
    """
    with redirect_output(log_file) as terminal:
        app = ConsoleApp(client, keymap, terminal=terminal, folder=folder, look=look, first=first)
        with exit_on_signals(app.end_threadsafe, terminal):
            # No mouse events for widgets: mouse.py captures the mouse and discards its reports.
            code = app.run(mouse=False)
    if code is None:
        sys.stderr.write(
            f"groundstation: internal error: {log_file or 'run with --log-file: the log'} has the details\n"
        )
        return 1
    return code
