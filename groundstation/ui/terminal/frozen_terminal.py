"""Whether a frozen terminal would be noticed. Programs in between that answer the pings of the screen hide it.

mosh-server answers DSR for a client that it has not heard for minutes, and so does GNU screen; neither tells a program
in it who is there. tmux does (tmux.py), but not whether the SSH connection or mosh below its client still carries
anything. With the styles latch and step a vehicle would drive on until OPR_TIMEOUT. Source: mosh's
src/terminal/terminalfunctions.cc (CSI_DSR), screen's ansi.c, tmux's input.c (INPUT_CSI_DSR).
"""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from groundstation.input.style import Style

PROC = Path("/proc")
PROXIES = {"mosh-server": "mosh", "screen": "GNU screen"}
"""Name of a process -> what it is called."""
BELOW_TMUX = {**PROXIES, "sshd": "tmux over ssh", "sshd-session": "tmux over ssh"}
"""The same for an ancestor of a client of tmux. Without tmux, ssh hides nothing: pings go through to the terminal."""
MOST_ANCESTORS = 64
PS = ("ps", "-axo", "pid=,ppid=,comm=")
PS_WITHIN = 1.0
"""s for the list of all processes; it takes some 20 ms."""


def find_proxy(environment: Mapping[str, str] = os.environ, pid: int | None = None, proc: Path = PROC) -> str:
    """Return what answers in place of the terminal, e.g. "mosh"; "" if nothing is known that does.

    In tmux that depends on its clients, which come and go: find_proxy_of_clients.
    """
    if environment.get("STY"):
        return PROXIES["screen"]
    names = _ancestors(os.getpid() if pid is None else pid, proc)
    return next((PROXIES[name] for name in names if name in PROXIES), "")


def find_proxy_of_clients(pids: Iterable[int], proc: Path = PROC) -> str:
    """Return what answers for the terminal of one of these clients of tmux; "" if nothing is known that does."""
    names = (name for pid in pids for name in _ancestors(pid, proc))
    return next((BELOW_TMUX[name] for name in names if name in BELOW_TMUX), "")


def style_refusal(style: str, proxy: str) -> str:
    """Return why keys must not drive in this style; "" if they may."""
    if style == Style.HOLD or not proxy:
        return ""
    return f"{style} drives on when the terminal freezes, which {proxy} hides: style hold only, or plain ssh"


def _ancestors(pid: int, proc: Path) -> Iterator[str]:
    """Yield the names of a process and its ancestors; none where the system does not tell."""
    parent_of = (lambda each: _read_status(each, proc)) if proc.is_dir() else _list_processes().get
    for _ in range(MOST_ANCESTORS):
        if (found := parent_of(pid)) is None:
            return
        name, pid = found
        yield name
        if pid < 1:
            return


def _read_status(pid: int, proc: Path) -> tuple[str, int] | None:
    """Return the name and the parent of a process from procfs."""
    try:
        lines = (proc / str(pid) / "status").read_text(errors="replace").splitlines()
    except OSError:
        return None
    fields = dict(line.split(":", 1) for line in lines if ":" in line)
    return fields.get("Name", "").strip(), int(fields.get("PPid", "0"))


def _list_processes() -> dict[int, tuple[str, int]]:
    """Return the name and the parent of each process, as ps lists them where there is no procfs."""
    try:
        listed = subprocess.run(PS, stdin=subprocess.DEVNULL, capture_output=True, timeout=PS_WITHIN, check=True)
    except (OSError, subprocess.SubprocessError):
        return {}
    found = {}
    for line in listed.stdout.decode(errors="replace").splitlines():
        pid, parent, command = line.split(None, 2)
        # macOS lists the path of the program, or its title, as "sshd: user@ttys001".
        found[int(pid)] = command.partition(":")[0].rpartition("/")[2], int(parent)
    return found
