"""Whether a frozen terminal would be noticed. Programs in between that answer the pings of the screen hide it.

mosh-server answers DSR for a client that it has not heard for minutes, and so does GNU screen; neither tells a program
in it who is there. tmux does (tmux.py), but not whether the SSH connection or mosh below its client still carries
anything. With the styles latch and step a vehicle would drive on until OPR_TIMEOUT. Source: mosh's
src/terminal/terminalfunctions.cc (CSI_DSR), screen's ansi.c, tmux's input.c (INPUT_CSI_DSR).
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from groundstation.input.style import Style

PROC = Path("/proc")
PROXIES = {"mosh-server": "mosh", "screen": "GNU screen"}
"""Name of a process -> what it is called."""
BELOW_TMUX = {**PROXIES, "sshd": "tmux over ssh", "sshd-session": "tmux over ssh"}
"""The same for an ancestor of a client of tmux. Without tmux, ssh hides nothing: pings go through to the terminal."""
MOST_ANCESTORS = 64


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
    for _ in range(MOST_ANCESTORS):
        try:
            lines = (proc / str(pid) / "status").read_text(errors="replace").splitlines()
        except OSError:
            return
        fields = dict(line.split(":", 1) for line in lines if ":" in line)
        yield fields.get("Name", "").strip()
        pid = int(fields.get("PPid", "0"))
        if pid < 1:
            return
