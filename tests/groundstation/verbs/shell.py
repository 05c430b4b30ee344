"""Asks shells what they propose, with the script of `groundstation completion`."""

from __future__ import annotations

import os
import pty
import select
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from groundstation.cli.verb_help import LOCAL_HELP, VERB_HELP
from groundstation.verbs.completion import build_script

HELPS = {**VERB_HELP, **LOCAL_HELP}
ASK = """
COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
_groundstation; printf '%s\\n' "${{COMPREPLY[@]}}"
"""
COMMANDS = {"bash": ("bash", "--norc", "-i"), "zsh": ("zsh", "-f", "-i"), "fish": ("fish", "--no-config", "-i")}
STAND_IN = {
    "fish": "function groundstation; if test $argv[1] = completion; command groundstation $argv; "
    "else; printf '<%s>' $argv; printf 'end%s\\n' ed; end; end",
}
"""Shell -> a function in the place of the program: it prints what it is called with, but answers completions."""
USUAL_STAND_IN = (
    'groundstation() { if [ "$1" = completion ]; then command groundstation "$@"; '
    "else printf '<%s>' \"$@\"; printf 'end%s\\n' ed; fi; }"
)
PATIENCE = 60.0
"""s for a shell to answer; it takes a tenth."""


def complete(words: str, folder: Path) -> set[str]:
    """Return what bash proposes for the last word."""
    script = build_script("bash", HELPS) + ASK.format(words=words)
    ended = subprocess.run(
        ["bash", "-c", script], cwd=folder, env=_environment(), capture_output=True, text=True, timeout=30
    )
    assert (ended.returncode, ended.stderr) == (0, "")
    return set(ended.stdout.split())


def type_and_tab(shell: str, lines: Sequence[str], folder: Path) -> list[str]:
    """Type each line into an interactive shell, then TAB and ENTER; return the words that the program gets."""
    script = folder / f"completion.{shell}"
    script.write_text(build_script(shell, HELPS))
    keyboard, screen = pty.openpty()
    with subprocess.Popen(
        ("setsid", "--ctty", *COMMANDS[shell]),
        cwd=folder,
        env=_environment(),
        stdin=screen,
        stdout=screen,
        stderr=screen,
    ) as process:
        os.close(screen)
        try:
            first = f"{STAND_IN.get(shell, USUAL_STAND_IN)}\nsource {script.name}; groundstation ready\n"
            _ask(keyboard, first)
            return [_ask(keyboard, f"{line}\t\n") for line in lines]
        finally:
            process.send_signal(signal.SIGKILL)
            os.close(keyboard)


def _ask(keyboard: int, text: str) -> str:
    """Type; return what the stand-in prints."""
    os.write(keyboard, text.encode())
    drawn, deadline = "", time.monotonic() + PATIENCE
    while ">ended" not in drawn:
        assert time.monotonic() < deadline, drawn
        if select.select([keyboard], [], [], 0.1)[0]:
            drawn += os.read(keyboard, 65536).decode(errors="replace")
    return drawn[: drawn.index(">ended") + 1].splitlines()[-1].rpartition("\r")[2]


def _environment() -> dict[str, str]:
    """Return ours, with the `groundstation` of this interpreter first."""
    return os.environ | {"PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}", "TERM": "xterm"}
