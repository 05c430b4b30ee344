"""Asks shells what they propose, with the script of `mavhelm completion`."""

from __future__ import annotations

import os
import pty
import select
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Self

import pytest

from groundstation.cli.verb_help import EVERY_VERB
from groundstation.verbs.completion import build_script
from tests.waits import PATIENCE

PROGRAM = Path(sys.executable).parent / "mavhelm"
HELPS = {name: verb.help for name, verb in EVERY_VERB.items()}
ASK = """
COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
_mavhelm; printf '%s\\n' "${{COMPREPLY[@]}}"
"""
COMMANDS = {"bash": ("bash", "--norc", "-i"), "zsh": ("zsh", "-f", "-i"), "fish": ("fish", "--no-config", "-i")}
STAND_IN = """#!/bin/sh
if [ "$1" = completion ]; then {names}; fi
printf '%s\\0' "$@" > {arguments}
printf 'end%s\\n' ed
"""
"""A program in the place of ours: it writes down what it is called with, but answers completions."""
ENDED = "ended"


def skip_without(shell: str) -> None:
    """Skip a test on a laptop without this shell; CI has all."""
    if shutil.which(shell) is None:
        assert "MAVHELM_CI" not in os.environ, f"{shell} is not installed: .ci/run installs it"
        pytest.skip(f"{shell} is not installed")


def complete(words: str, folder: Path) -> set[str]:
    """Return what bash proposes for the last word."""
    script = build_script("bash", HELPS) + ASK.format(words=words)
    ended = subprocess.run(
        ["bash", "-c", script], cwd=folder, env=_environment(), capture_output=True, text=True, timeout=30
    )
    assert (ended.returncode, ended.stderr) == (0, "")
    return set(ended.stdout.split())


class InteractiveShell:
    """A shell in a pty, as a person uses it, whose `mavhelm` is a stand-in that only notes its arguments."""

    def __init__(self, shell: str, folder: Path, names: bytes | None = None) -> None:
        """`folder`: where it begins. `names`: a hostile answer to `--names`; None: our program answers."""
        self._work = Path(tempfile.mkdtemp(prefix="mavhelm-shell-"))
        self._arguments = self._work / "arguments"
        self._write_stand_in(names)
        script = self._work / f"completion.{shell}"
        script.write_text(build_script(shell, HELPS))
        self._keyboard, screen = pty.openpty()
        self._process = subprocess.Popen(
            ("setsid", "--ctty", *COMMANDS[shell]),
            cwd=folder,
            env=_environment(self._work),
            stdin=screen,
            stdout=screen,
            stderr=screen,
        )
        os.close(screen)
        self.type(f"source {script}; mavhelm ready\n")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.wait()
        os.close(self._keyboard)
        shutil.rmtree(self._work)

    def tab(self, line: str) -> list[str]:
        """Type the beginning of a line, TAB and ENTER; return the words that the program gets."""
        return self.type(f"{line}\t\n")

    def type(self, keys: str) -> list[str]:
        """Type; return the words that the program gets."""
        os.write(self._keyboard, keys.encode())
        drawn, deadline = "", time.monotonic() + PATIENCE
        while ENDED not in drawn:
            assert time.monotonic() < deadline, drawn
            if select.select([self._keyboard], [], [], 0.1)[0]:
                drawn += os.read(self._keyboard, 65536).decode(errors="replace")
        return self._arguments.read_bytes().decode().split("\0")[:-1]

    def _write_stand_in(self, names: bytes | None) -> None:
        (self._work / "names").write_bytes(names or b"")
        answer = f"cat {self._work / 'names'}" if names is not None else f'"{PROGRAM}" "$@"'
        program = self._work / "mavhelm"
        program.write_text(STAND_IN.format(names=f"{answer}; exit", arguments=self._arguments))
        program.chmod(0o755)


def _environment(first: Path = PROGRAM.parent) -> dict[str, str]:
    """Return ours, with the `mavhelm` of the folder `first`."""
    return os.environ | {"PATH": f"{first}:{os.environ['PATH']}", "TERM": "xterm"}
