r"""Mouse wheel protection: ask the terminal for mouse reports; escape_sequences.py discards every report.

Without mouse reports many terminals turn the wheel into arrow keys on the alternate screen ("alternate scroll", DEC
private mode 1007), and the up arrow means "drive forward". Switching mode 1007 off is enough for most terminals, but
does not reach the terminal outside of tmux; asking for mouse reports does. See "Mouse Tracking" in
https://invisible-island.net/xterm/ctlseqs/ctlseqs.html.
"""

from __future__ import annotations

SAVE_WHEEL_MODE = "\x1b[?1007s"
"""XTSAVE of the alternate scroll mode: its default differs between terminals (on in VTE, off in xterm)."""

CAPTURE_MOUSE = "\x1b[?1000;1006h\x1b[?1007l"
"""Report buttons and the wheel (1000) with decimal coordinates (1006), and switch alternate scroll off (1007).

Motion (1002, 1003) is not reported: each report would wake the input thread.
"""

RELEASE_MOUSE = "\x1b[?1000;1006l\x1b[?1007h\x1b[?1007r"
"""Undo CAPTURE_MOUSE. Terminals that know XTRESTORE end with the saved mode 1007, the others with it switched on."""
